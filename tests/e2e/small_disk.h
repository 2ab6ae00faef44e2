// A file system in memory that is soon full.
#pragma once

#include <filesystem>

#include <sys/mount.h>

namespace forceshade::testing {

/// Of limited size ("size=256k"), mounted until the end of the object; bad() where mounting is not permitted.
class SmallDisk {
public:
    SmallDisk(std::filesystem::path at, const char* size) : at_(std::move(at)) {
        std::filesystem::create_directory(at_);
        mounted_ = ::mount("tmpfs", at_.c_str(), "tmpfs", 0, size) == 0;
    }
    ~SmallDisk() {
        if (mounted_)
            ::umount2(at_.c_str(), MNT_DETACH);
    }
    SmallDisk(const SmallDisk&) = delete;
    SmallDisk& operator=(const SmallDisk&) = delete;

    bool bad() const { return !mounted_; }
    bool change(unsigned long flags, const char* size) const {
        return ::mount("tmpfs", at_.c_str(), "tmpfs", MS_REMOUNT | flags, size) == 0;
    }

private:
    std::filesystem::path at_;
    bool mounted_ = false;
};

} // namespace forceshade::testing
