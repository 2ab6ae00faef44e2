// A vendor's library, found and loaded while the program runs: the program is built and works without it.
#pragma once

#include <string>
#include <vector>

namespace forceshade::device {

/// Where a library is looked for, and what to say to who does not have it.
struct SoughtLibrary {
    std::string product;            // "Force Dimension SDK"
    std::string variable;           // of the environment; where it is set, the file it names is taken and no other
    std::vector<std::string> names; // tried in this order where the dynamic linker looks
    std::string installation;       // one sentence: where it comes from and where to put it
};

/// A loaded library. Its code and its texts stay until the program ends, even when this is gone: threads that the
/// vendor started may still be in it, and complaints point into it.
class SharedLibrary {
public:
    /// \throws DeviceAbsent: names what was tried and how to install it.
    explicit SharedLibrary(const SoughtLibrary& sought);
    ~SharedLibrary();
    SharedLibrary(const SharedLibrary&) = delete;
    SharedLibrary& operator=(const SharedLibrary&) = delete;

    const std::string& file() const { return file_; } // as the dynamic linker found it

    /// Sets `call` to the function of that name. \throws DeviceAbsent if there is none, with library and name.
    template <typename Function> void load(Function*& call, const char* name) const {
        call = reinterpret_cast<Function*>(needed(name));
    }

    /// Likewise; null if there is none.
    template <typename Function> void load_if_there(Function*& call, const char* name) const noexcept {
        call = reinterpret_cast<Function*>(find(name));
    }

private:
    void* find(const char* name) const noexcept;
    void* needed(const char* name) const;

    std::string product_, file_;
    void* handle_ = nullptr;
};

} // namespace forceshade::device
