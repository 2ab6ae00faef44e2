// A vendor's library, found and loaded while the program runs: the program is built and works without it.
#pragma once

#include <string>
#include <vector>

namespace forceshade::device {

/// Where a library is looked for, and what to tell a user who does not have it.
struct SoughtLibrary {
    std::string product;            // "Force Dimension SDK"
    std::string variable;           // of the environment; where it is set, only the file that it names is tried
    std::vector<std::string> names; // tried in this order where the dynamic linker looks
    std::string installation;       // one sentence: where it comes from and where to put it
};

/// A loaded library. It stays loaded until the program ends: threads that the vendor started may still run in it, and
/// complaints point into it.
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

    /// \throws DeviceAbsent if there is none of that name, with library and name.
    Symbol needed(const char* name) const;
    /// Null if there is none.
    Symbol optional(const char* name) const noexcept;

private:
    std::string product_, file_;
    void* handle_;
};

} // namespace forceshade::device
