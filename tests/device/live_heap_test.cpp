// From the first sample to the last the loop's thread takes nothing from the heap, locks nothing, throws nothing and
// writes nowhere.
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <stdexcept>
#include <thread>

#include <dlfcn.h>
#include <pthread.h>
#include <unistd.h>

#include <gtest/gtest.h>

#include "device/backends/devices.h"
#include "tests/device/scripted_device.h"
#include "tests/places.h"

namespace {

thread_local bool watched = false; // this thread is at work
std::atomic<std::uint64_t> taken = 0, given = 0, locked = 0, thrown = 0, written = 0;

void count(std::atomic<std::uint64_t>& what) {
    if (watched)
        what.fetch_add(1, std::memory_order_relaxed);
}

template <typename Function> Function real(const char* name) {
    return reinterpret_cast<Function>(::dlsym(RTLD_NEXT, name));
}

} // namespace

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define FORCESHADE_INTERPOSES 1
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void __libc_free(void*);

void* malloc(std::size_t size) {
    count(taken);
    return __libc_malloc(size);
}
void* calloc(std::size_t number, std::size_t size) {
    count(taken);
    return __libc_calloc(number, size);
}
void* realloc(void* place, std::size_t size) {
    count(taken);
    return __libc_realloc(place, size);
}
void free(void* place) {
    count(given);
    __libc_free(place);
}
int pthread_mutex_lock(pthread_mutex_t* mutex) {
    count(locked);
    static const auto lock = real<int (*)(pthread_mutex_t*)>("pthread_mutex_lock");
    return lock(mutex);
}
ssize_t write(int descriptor, const void* bytes, std::size_t size) {
    count(written);
    static const auto put = real<ssize_t (*)(int, const void*, std::size_t)>("write");
    return put(descriptor, bytes, size);
}
void* __cxa_allocate_exception(std::size_t size) noexcept {
    count(thrown);
    static const auto allocate = real<void* (*)(std::size_t)>("__cxa_allocate_exception");
    return allocate(size);
}
}
#endif

namespace forceshade::device {
namespace {

using namespace testing;

// A device in front of another, that tells when the loop is at work.
class Watched final : public BackEnd {
public:
    Watched(BackEnd& behind, std::uint64_t samples) : behind_(behind), samples_(samples) {}

    const DeviceFacts& facts() const noexcept override { return behind_.facts(); }
    Reading read() noexcept override {
        watched = asked_ > 0 && asked_ + 1 < samples_; // from the end of the first sample to the begin of the last
        ++asked_;
        return behind_.read();
    }
    bool write(const glm::dvec3& force) noexcept override { return behind_.write(force); }
    void halt() noexcept override { behind_.halt(); }
    const char* error_text() const noexcept override { return nullptr; }

private:
    BackEnd& behind_;
    const std::uint64_t samples_;
    std::uint64_t asked_ = 0;
};

std::uint64_t all() {
    return taken + given + locked + thrown + written;
}

TEST(LiveHeap, TheCountersBite) {
#if !defined(FORCESHADE_INTERPOSES)
    GTEST_SKIP() << "the sanitizer has the heap";
#endif
    watched = true;
    std::free(std::malloc(1 + static_cast<std::size_t>(std::rand() % 2)));
    std::mutex mutex;
    mutex.lock();
    mutex.unlock();
    try {
        throw std::runtime_error("a message that is long enough to need the heap for itself");
    } catch (const std::exception&) {
    }
    EXPECT_EQ(::write(STDERR_FILENO, "", 0), 0);
    watched = false;
    EXPECT_GE(taken, 2u);
    EXPECT_GE(given, 2u);
    EXPECT_EQ(locked, 1u);
    EXPECT_EQ(thrown, 1u);
    EXPECT_EQ(written, 1u);
}

TEST(LiveHeap, TheLoopTakesNothing) {
#if !defined(FORCESHADE_INTERPOSES)
    GTEST_SKIP() << "the sanitizer has the heap";
#endif
    const std::string spot = std::string("[surface]\nkind = \"mesh\"\nfile = \"") + in_source("tests/data") +
                             "/spot.obj\"\ntransform = { scale = 0.05, rotate = [\"90 deg\", \"0 deg\", \"0 deg\"] }\n"
                             "[force]\nshading = \"mean_value\"\n";
    const std::string bump = "[surface]\nfacets = 3\n[force]\nshading = \"reference\"\n";
    const std::string walk = "[paths]\nkind = \"random_walk\"\npress = \"1 N\"\n";
    const std::string friction = "[friction]\nstatic_coefficient = 0.5\ndamping = \"0.1 N s/m\"\n";
    for (const std::string& scene : {spot, spot + walk, bump, bump + walk, bump + friction + walk})
        for (const bool in_real_time : {false, true}) {
            const std::uint64_t samples = in_real_time ? 600 : 20000;
            const PreparedCase prepared = prepared_scene(scene);
            const auto sim = make_sim(prepared, 2000, 0, parse_held_buttons("1@0 s..600 s,2@0.1 s..0.15 s"));
            Watched device(*sim, samples);
            LoopSettings settings;
            settings.rate = 2000;
            settings.real_time = in_real_time;
            settings.samples = samples;
            settings.limits.passivity = kPassiveDamping;
            settings.dead_man = 1;
            settings.clutch = 2;
            settings.mapping = {glm::dvec3(0), turn_about(2, 0.1), 1.1};
            SampleRing ring(samples), other(64);
            LiveLoop loop(device, make_probe_law(prepared), settings, &ring, {&other});
            const std::uint64_t before = all();
            loop.start();
            for (int i = 0; i < 3; ++i) {
                std::this_thread::sleep_for(std::chrono::milliseconds(20));
                loop.offer(make_probe_law(prepared));
            }
            loop.join();
            EXPECT_EQ(all(), before) << scene << in_real_time;
            EXPECT_EQ(loop.counts().samples, samples);
            EXPECT_GT(loop.counts().in_contact, 100u); // a hand that wanders falls off
        }
}

} // namespace
} // namespace forceshade::device
