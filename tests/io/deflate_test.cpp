// Blocks packed and unpacked by libdeflate: zlib unpacks them, damage is an error, and OpenEXR does call it.
#include <algorithm>
#include <atomic>
#include <dlfcn.h>
#include <new>
#include <random>
#include <string>

#include <gtest/gtest.h>
#include <zlib.h>

#include "host/output/raw_formats.h"
#include "host/threads.h"

namespace forceshade {
namespace {

std::string some_bytes(std::size_t size, unsigned different) {
    std::mt19937 random(1);
    std::string bytes(size, '\0');
    for (char& byte : bytes)
        byte = static_cast<char>(random() % different);
    return bytes;
}

std::string packed(const std::string& from, int level) {
    std::vector<std::byte> to;
    deflate(std::as_bytes(std::span(from)), to, level);
    return {reinterpret_cast<const char*>(to.data()), to.size()};
}

// By zlib's stream, which nobody replaces.
std::string unpacked_by_zlib(std::string from, std::size_t size) {
    std::string to(size, '\0');
    z_stream stream{};
    stream.next_in = reinterpret_cast<Bytef*>(from.data());
    stream.avail_in = static_cast<uInt>(from.size());
    stream.next_out = reinterpret_cast<Bytef*>(to.data());
    stream.avail_out = static_cast<uInt>(to.size());
    EXPECT_EQ(inflateInit(&stream), Z_OK);
    EXPECT_EQ(inflate(&stream, Z_FINISH), Z_STREAM_END);
    to.resize(stream.total_out);
    inflateEnd(&stream);
    return to;
}

TEST(Deflate, IsReadByZlib) {
    for (const std::size_t size : {1u, 100u, 100000u, 1000003u})
        for (const unsigned different : {1u, 7u, 256u}) // the last cannot be made smaller
            for (const int level : {1, 4, 9}) {
                const std::string bytes = some_bytes(size, different);
                EXPECT_EQ(unpacked_by_zlib(packed(bytes, level), size + 1), bytes) << size << ' ' << different;
            }
}

TEST(Deflate, UnpacksTheSameBlockAgainAndAnotherAfterIt) {
    const std::string one = some_bytes(5000, 9), other = some_bytes(7000, 5);
    for (const std::string* bytes : {&one, &one, &other, &one}) {
        const std::string small = packed(*bytes, 4);
        std::string to(bytes->size(), '\0');
        uLongf room = to.size();
        ASSERT_EQ(::uncompress(reinterpret_cast<Bytef*>(to.data()), &room, reinterpret_cast<const Bytef*>(small.data()),
                               small.size()),
                  Z_OK);
        EXPECT_EQ(room, bytes->size());
        EXPECT_EQ(to, *bytes);
    }
}

TEST(Deflate, TellsOfDamageAndOfTooLittleRoom) {
    std::string small = packed(some_bytes(5000, 9), 4), to(5000, '\0');
    uLongf room = 100;
    const auto unpack = [&] {
        return ::uncompress(reinterpret_cast<Bytef*>(to.data()), &room, reinterpret_cast<const Bytef*>(small.data()),
                            small.size());
    };
    EXPECT_EQ(unpack(), Z_BUF_ERROR);
    room = to.size();
    small[small.size() / 2] ^= 0x55;
    EXPECT_EQ(unpack(), Z_DATA_ERROR);
}

TEST(ShareOut, PassesOnWhatAThreadThrows) {
    for (const std::size_t threads : {1U, 4U}) {
        EXPECT_THROW(share_out(threads, 1000,
                               [](std::size_t, std::size_t i) {
                                   if (i == 500)
                                       throw std::bad_alloc();
                               }),
                     std::bad_alloc);
        std::vector<std::atomic<int>> times(1000);
        share_out(threads, times.size(), [&](std::size_t, std::size_t i) { ++times[i]; });
        EXPECT_TRUE(std::ranges::all_of(times, [](const std::atomic<int>& one) { return one == 1; }));
    }
}

// The dynamic linker gives OpenEXR the first of that name, and that is the program's.
TEST(Deflate, IsWhatOpenExrCalls) {
    EXPECT_NE(deflate_name().find("libdeflate "), std::string::npos);
    void* const found = ::dlsym(RTLD_DEFAULT, "uncompress");
    ASSERT_NE(found, nullptr);
    Dl_info where{};
    ASSERT_NE(::dladdr(found, &where), 0);
    EXPECT_EQ(std::string(where.dli_fname).find("libz"), std::string::npos) << where.dli_fname;
}

} // namespace
} // namespace forceshade
