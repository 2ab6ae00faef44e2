// A renderer's process: loads the library, calls it, and measures each call.
#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <dlfcn.h>
#include <exception>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>
#include <vector>

#include <fmt/format.h>

#include "host/clock.h"
#include "host/renderer/renderer_exchange.h"
#include "host/renderer/renderer_process.h"

namespace forceshade {
namespace {

constexpr std::size_t kOtherMemory = std::size_t(1) << 26; // bytes, that fill the caches
constexpr std::uint64_t kGuard = 0x5A5A0FF1CE5A5A5A;

struct Functions {
    decltype(&fsr_version) version;
    decltype(&fsr_open) open;
    decltype(&fsr_reset) reset;
    decltype(&fsr_update) update;
    decltype(&fsr_error) error;
    decltype(&fsr_close) close;
};

// An answer between numbers that a renderer must leave as they are.
struct GuardedTouch {
    std::array<std::uint64_t, 32> before;
    fsr_touch touch;
    std::array<std::uint64_t, 32> after;

    void prepare() {
        before.fill(kGuard);
        after.fill(kGuard);
        touch = {};
    }
    bool intact() const {
        const auto is_guard = [](std::uint64_t word) { return word == kGuard; };
        return std::ranges::all_of(before, is_guard) && std::ranges::all_of(after, is_guard);
    }
};

class Child {
public:
    explicit Child(RendererExchange& exchange) : exchange_(exchange) {}

    int run(const std::string& library) {
        try {
            return serve(library);
        } catch (const std::exception& error) {
            say(fmt::format("threw an exception: {}", error.what()));
        } catch (...) {
            say("threw an exception");
        }
        return refuse();
    }

private:
    int serve(const std::string& library) {
        wait();
        exchange_.stage = kRendererLoading;
        if (!load(library) || !open())
            return refuse();
        for (;;) {
            exchange_.stage = kRendererReady;
            ::sem_post(&exchange_.reply);
            wait();
            if (exchange_.what == kRendererEnd)
                break;
            exchange_.stage = kRendererUpdating;
            if (!update())
                return refuse();
        }
        exchange_.stage = kRendererClosing;
        functions_.close(renderer_);
        return 0;
    }

    void wait() {
        while (::sem_wait(&exchange_.request) != 0) {
        }
    }

    bool say(const std::string& text) {
        text_ = text;
        return false;
    }
    int refuse() {
        exchange_.text.fill('\0');
        std::copy_n(text_.data(), std::min(text_.size(), exchange_.text.size() - 1), exchange_.text.data());
        exchange_.refused = 1;
        ::sem_post(&exchange_.reply);
        return 1;
    }

    template <typename Function> bool find(void* library, const char* name, Function& function) {
        function = reinterpret_cast<Function>(::dlsym(library, name));
        return function != nullptr ||
               say(fmt::format("has no function {}; export those of forceshade_renderer.h", name));
    }

    bool load(const std::string& file) {
        void* const library = ::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
        if (library == nullptr)
            return say(fmt::format("cannot be loaded: {}", ::dlerror()));
        if (!find(library, "fsr_version", functions_.version) || !find(library, "fsr_open", functions_.open) ||
            !find(library, "fsr_reset", functions_.reset) || !find(library, "fsr_update", functions_.update) ||
            !find(library, "fsr_error", functions_.error) || !find(library, "fsr_close", functions_.close))
            return false;
        const int version = functions_.version();
        return version == FSR_VERSION || say(fmt::format("is of version {} of forceshade_renderer.h, this program of "
                                                         "version {}; compile it with this program's header",
                                                         version, FSR_VERSION));
    }

    bool open() {
        exchange_.stage = kRendererOpening;
        const auto* at = reinterpret_cast<const char*>(&exchange_ + 1);
        const auto take = [&](std::size_t bytes) {
            const char* const here = at;
            at += bytes;
            return here;
        };
        fsr_scene scene{};
        scene.vertices = reinterpret_cast<const double*>(take(exchange_.vertex_count * 3 * sizeof(double)));
        scene.vertex_count = exchange_.vertex_count;
        scene.corners = reinterpret_cast<const int*>(take(exchange_.triangle_count * 3 * sizeof(int)));
        scene.triangle_count = exchange_.triangle_count;
        scene.surface = take(exchange_.surface_bytes);
        scene.toml = take(exchange_.toml_bytes);
        scene.options = take(exchange_.options_bytes);
        scene.extent = exchange_.extent;
        scene.stiffness = exchange_.stiffness;
        scene.period = exchange_.period;
        scene_ = scene;
        return check(functions_.open(&scene_, &renderer_));
    }

    bool check(int error) {
        if (error == 0)
            return true;
        const char* const meaning = functions_.error(renderer_, error);
        return say(fmt::format("returned error {}{}{}", error, meaning != nullptr && *meaning != '\0' ? ": " : "",
                               meaning != nullptr ? meaning : ""));
    }

    bool update() {
        const double clock = clock_seconds();
        for (std::uint32_t i = 0; i < exchange_.count; ++i) {
            RendererItem& item = exchange_.items[i];
            const double probe[3] = {item.probe[0], item.probe[1], item.probe[2]};
            touch_.prepare();
            const bool begins =
                exchange_.begins == kRendererEachBegins || (exchange_.begins == kRendererBegins && i == 0);
            if (begins && !check(functions_.reset(renderer_)))
                return false;
            if (exchange_.cold != 0)
                fill_caches();
            const Clock::time_point start = Clock::now();
            const int error = functions_.update(renderer_, probe, &touch_.touch);
            item.seconds = std::max(seconds_since(start) - clock, 0.0);
            if (!touch_.intact())
                return say("wrote beyond its answer");
            if (!check(error))
                return false;
            item.touch = touch_.touch;
            exchange_.done = i + 1;
        }
        return true;
    }

    void fill_caches() {
        other_.resize(kOtherMemory);
        for (std::size_t i = 0; i < other_.size(); i += 64)
            ++other_[i];
    }

    RendererExchange& exchange_;
    Functions functions_{};
    fsr_scene scene_{};
    void* renderer_ = nullptr;
    GuardedTouch touch_{};
    std::string text_;
    std::vector<char> other_;
};

} // namespace

int serve_renderer(const std::string& library) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    for (const int signal : {SIGINT, SIGHUP, SIGTERM})
        std::signal(signal, SIG_IGN); // the program ends this process
    const rlimit none{0, 0};
    ::setrlimit(RLIMIT_CORE, &none);
    struct stat file {};
    if (::fstat(kRendererDescriptor, &file) != 0 || static_cast<std::size_t>(file.st_size) < sizeof(RendererExchange))
        return 2;
    void* const mapped = ::mmap(nullptr, static_cast<std::size_t>(file.st_size), PROT_READ | PROT_WRITE, MAP_SHARED,
                                kRendererDescriptor, 0);
    if (mapped == MAP_FAILED)
        return 2;
    auto& exchange = *static_cast<RendererExchange*>(mapped);
    if (::getppid() != exchange.program) // it ended before PR_SET_PDEATHSIG
        return 2;
    return Child(exchange).run(library);
}

} // namespace forceshade
