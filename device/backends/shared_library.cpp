#include "device/backends/shared_library.h"

#include <cmath>
#include <cstdlib>
#include <dlfcn.h>

#include <fmt/format.h>
#include <link.h>

#include "device/backends/back_end.h"

namespace forceshade::device {

namespace {

// On failure null, with the linker's error in `why`.
void* open_library(const std::string& name, std::string& why) {
    void* handle = ::dlopen(name.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
    if (!handle) {
        const char* error_text = ::dlerror();
        why = error_text ? error_text : name + ": cannot be loaded";
    }
    return handle;
}

void* open_sought(const SoughtLibrary& sought) {
    std::string why, load_errors;
    if (const char* const file = std::getenv(sought.variable.c_str()); file && *file) {
        if (void* handle = open_library(file, why))
            return handle;
        throw DeviceAbsent("cannot load the library of the {} from ${}: {}. {}", sought.product, sought.variable, why,
                           sought.installation);
    }
    for (const std::string& name : sought.names) {
        if (void* handle = open_library(name, why))
            return handle;
        // Ignore "not found"; report libraries that exist but fail to load.
        if (!why.starts_with(name + ": cannot open shared object file: No such file"))
            load_errors += "; " + why;
    }
    throw DeviceAbsent(
        "no library of the {}: none of {} is in LD_LIBRARY_PATH or the system's folders, and {} is not set{}. {}",
        sought.product, fmt::join(sought.names, ", "), sought.variable, load_errors, sought.installation);
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
    throw DeviceAbsent("{} has no function {}: it is not the library of the {}, or is too old", file_, name, product_);
}

bool is_reachable(const glm::dvec3& at) {
    const auto is_near = [](double along) { return std::abs(along) <= kReachOfDevices; };
    return is_near(at.x) && is_near(at.y) && is_near(at.z);
}

void require_plausible_force(const std::string& name, double most) {
    if (!(most >= 0.5 && most <= 200))
        throw DeviceAbsent("{} states a largest force of {} N: between 0.5 N and 200 N is plausible", name, most);
}

} // namespace forceshade::device
