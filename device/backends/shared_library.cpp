#include "device/backends/shared_library.h"

#include <cstdlib>
#include <dlfcn.h>

#include <fmt/format.h>
#include <link.h>

#include "device/backends/back_end.h"

namespace forceshade::device {

namespace {

// Null, or the linker's complaint in `why`.
void* open_library(const std::string& name, std::string& why) {
    void* handle = ::dlopen(name.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
    if (!handle) {
        const char* complaint = ::dlerror();
        why = complaint ? complaint : name + ": cannot be loaded";
    }
    return handle;
}

// That a name is nowhere is no news; that a library is there and cannot be loaded is.
bool is_merely_absent(const std::string& name, const std::string& why) {
    return why.starts_with(name + ": cannot open shared object file: No such file");
}

void* open_named(const SoughtLibrary& sought, const char* file) {
    std::string why;
    if (void* handle = open_library(file, why))
        return handle;
    throw DeviceAbsent(fmt::format("the library that {} names cannot be loaded: {}; it is to be the {}'s. {}",
                                   sought.variable, why, sought.product, sought.installation));
}

void* open_found(const SoughtLibrary& sought) {
    std::string complaints;
    for (const std::string& name : sought.names) {
        std::string why;
        if (void* handle = open_library(name, why))
            return handle;
        if (!is_merely_absent(name, why))
            complaints += "; " + why;
    }
    throw DeviceAbsent(fmt::format("no library of the {}: none of {} is in LD_LIBRARY_PATH or the system's folders, "
                                   "and {} is not set{}. {}",
                                   sought.product, fmt::join(sought.names, ", "), sought.variable, complaints,
                                   sought.installation));
}

std::string file_of(void* handle) {
    link_map* map = nullptr;
    if (::dlinfo(handle, RTLD_DI_LINKMAP, &map) != 0 || !map || !map->l_name)
        return {};
    return map->l_name;
}

} // namespace

SharedLibrary::SharedLibrary(const SoughtLibrary& sought) : product_(sought.product) {
    const char* file = std::getenv(sought.variable.c_str());
    handle_ = file && *file ? open_named(sought, file) : open_found(sought);
    file_ = file_of(handle_);
}

SharedLibrary::~SharedLibrary() {
    ::dlclose(handle_);
}

void* SharedLibrary::find(const char* name) const noexcept {
    return ::dlsym(handle_, name);
}

void* SharedLibrary::needed(const char* name) const {
    if (void* symbol = find(name))
        return symbol;
    throw DeviceAbsent(fmt::format("{} has no function {}: it is another library than the {}'s, or too old a version",
                                   file_, name, product_));
}

} // namespace forceshade::device
