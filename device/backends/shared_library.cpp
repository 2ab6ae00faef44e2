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

void* open_sought(const SoughtLibrary& sought) {
    std::string why, complaints;
    if (const char* const file = std::getenv(sought.variable.c_str()); file && *file) {
        if (void* handle = open_library(file, why))
            return handle;
        throw DeviceAbsent(fmt::format("the library that {} names cannot be loaded: {}; it is to be the {}'s. {}",
                                       sought.variable, why, sought.product, sought.installation));
    }
    for (const std::string& name : sought.names) {
        if (void* handle = open_library(name, why))
            return handle;
        // That a name is nowhere is no news; that a library is there and cannot be loaded is.
        if (!why.starts_with(name + ": cannot open shared object file: No such file"))
            complaints += "; " + why;
    }
    throw DeviceAbsent(fmt::format("no library of the {}: none of {} is in LD_LIBRARY_PATH or the system's folders, "
                                   "and {} is not set{}. {}",
                                   sought.product, fmt::join(sought.names, ", "), sought.variable, complaints,
                                   sought.installation));
}

} // namespace

SharedLibrary::SharedLibrary(const SoughtLibrary& sought) : product_(sought.product), handle_(open_sought(sought)) {
    link_map* map = nullptr;
    if (::dlinfo(handle_, RTLD_DI_LINKMAP, &map) == 0 && map && map->l_name)
        file_ = map->l_name;
}

SharedLibrary::Symbol SharedLibrary::optional(const char* name) const noexcept {
    return {::dlsym(handle_, name)};
}

SharedLibrary::Symbol SharedLibrary::needed(const char* name) const {
    if (const Symbol symbol = optional(name); symbol.address)
        return symbol;
    throw DeviceAbsent(fmt::format("{} has no function {}: it is another library than the {}'s, or too old a version",
                                   file_, name, product_));
}

} // namespace forceshade::device
