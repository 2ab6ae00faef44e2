// A vendor's library, found and loaded while the program runs: the program is built and works without it. Also what no
// device that it drives can state.
#pragma once

#include <string>
#include <vector>

#include <glm/vec3.hpp>

namespace forceshade::device {

/// Where to look for a library, and how to install it.
struct SoughtLibrary {
    std::string product;            // "Force Dimension SDK"
    std::string variable;           // of the environment; if it is set, only its file is tried
    std::vector<std::string> names; // tried in this order where the dynamic linker looks
    std::string installation;       // one sentence: where it comes from and where to put it
};

/// A loaded library. It stays loaded until the program ends: threads that the vendor started may still run in it, and
/// error texts point into it.
class SharedLibrary {
public:
    /// \throws DeviceAbsent: names what was tried and how to install it.
    explicit SharedLibrary(const SoughtLibrary& sought);

    const std::string& file() const { return file_; } // as the dynamic linker found it

    /// A function of the library; becomes a pointer of whatever type it is assigned to.
    struct Symbol {
        void* address;
        template <typename Function> operator Function*() const noexcept {
            return reinterpret_cast<Function*>(address);
        }
    };

    /// \throws DeviceAbsent with library and name if it has no such function.
    Symbol needed(const char* name) const;
    /// Null if it has no such function.
    Symbol optional(const char* name) const noexcept;

private:
    std::string product_, file_;
    void* handle_;
};

inline constexpr double kReachOfDevices = 3; /* m: no device reaches further */
/// Whether a device can be there, m; false also for NaN.
bool is_reachable(const glm::dvec3& at);

/// \throws DeviceAbsent unless this device may have such a largest force, N.
void require_plausible_force(const std::string& name, double most);

} // namespace forceshade::device
