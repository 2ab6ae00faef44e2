#include "tests/mutation/trial.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <thread>
#include <variant>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fmt/format.h>

#include "host/cases/path_comparison.h"
#include "host/paths/recorded.h"
#include "host/referee/validate.h"
#include "shaders/kernels.h"
#include "tests/mutation/mutants.h"

namespace forceshade {
namespace {

namespace words {
#include "field_f32.spv.h"
#include "field_f32_packed.spv.h"
#include "field_f32_packed_lines.spv.h"
#include "field_f64.spv.h"
#include "field_f64_lines.spv.h"
#include "mesh_field_f32.spv.h"
#include "mesh_field_f32_lines.spv.h"
#include "mesh_field_f64.spv.h"
#include "mesh_field_f64_lines.spv.h"
#include "mesh_path_f32.spv.h"
#include "mesh_path_f32_lines.spv.h"
#include "mesh_path_f64.spv.h"
#include "mesh_path_f64_lines.spv.h"
#include "path_f32.spv.h"
#include "path_f32_lines.spv.h"
#include "path_f64.spv.h"
#include "path_f64_lines.spv.h"
} // namespace words

// In the place of the kernel whose words begin there.
const std::uint32_t* replaced = nullptr;
mutation::Words replacement;

std::span<const std::uint32_t> chosen(std::span<const std::uint32_t> own) {
    return own.data() == replaced ? std::span<const std::uint32_t>(replacement) : own;
}

} // namespace

// The linker takes these for the program's own, which lie in a library.
namespace kernels {

#define FS_KERNEL(name)                                                                                                \
    std::span<const std::uint32_t> name() {                                                                            \
        return chosen(words::name);                                                                                    \
    }
FS_KERNEL(field_f32)
FS_KERNEL(field_f32_packed)
FS_KERNEL(field_f64)
FS_KERNEL(mesh_field_f32)
FS_KERNEL(mesh_field_f64)
FS_KERNEL(path_f32)
FS_KERNEL(path_f64)
FS_KERNEL(mesh_path_f32)
FS_KERNEL(mesh_path_f64)
#undef FS_KERNEL
// No software device takes these.
#define FS_KERNEL(name)                                                                                                \
    std::span<const std::uint32_t> name() {                                                                            \
        return {};                                                                                                     \
    }
FS_KERNEL(field_f32_exact)
FS_KERNEL(mesh_field_f32_exact)
FS_KERNEL(path_f32_exact)
FS_KERNEL(mesh_path_f32_exact)
#undef FS_KERNEL

} // namespace kernels

namespace mutation {

const std::vector<Kernel>& kernels() {
    using enum Precision;
    using namespace words;
    using namespace layout;
    static const std::vector<Kernel> all{
        {"field", f32, false, false, field_f32_packed, field_f32_packed_lines, kBindForce, kChannelForce},
        {"field", f64, false, false, field_f64, field_f64_lines, kBindForce, kChannelForce},
        {"path", f32, false, true, path_f32, path_f32_lines, kPathBindForce, kChannelForce},
        {"path", f64, false, true, path_f64, path_f64_lines, kPathBindForce, kChannelForce},
        {"mesh_field", f32, true, false, mesh_field_f32, mesh_field_f32_lines, kMeshBindForce, kChannelForce},
        {"mesh_field", f64, true, false, mesh_field_f64, mesh_field_f64_lines, kMeshBindForce, kChannelForce},
        {"mesh_path", f32, true, true, mesh_path_f32, mesh_path_f32_lines, kMeshPathBindSamples, kChannelPosition},
        {"mesh_path", f64, true, true, mesh_path_f64, mesh_path_f64_lines, kMeshPathBindSamples, kChannelPosition}};
    return all;
}

std::vector<PreparedCase> load_scenes(const std::string& folder) {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        if (entry.path().extension() == ".toml")
            files.push_back(entry.path());
    std::ranges::sort(files);
    CasePreparation preparation;
    std::vector<PreparedCase> scenes;
    for (const std::filesystem::path& file : files) {
        scenes.push_back(preparation.prepare(read_scene(file)));
        scenes.back().one.name = file.stem().string();
        add_recorded_digest(scenes.back());
    }
    return scenes;
}

bool is_for(const Kernel& kernel, const PreparedCase& scene) {
    const Scene& described = scene.one.scene;
    return kernel.mesh == (scene.images.mesh != nullptr) &&
           (kernel.paths ? described.paths.has_value() : described.field);
}

namespace {

constexpr std::chrono::minutes kLongest(20); // of one process, which may also wait for nothing

// How a process ends: one of these and the scene's number.
constexpr int kSurvived = 0, kLeftToHost = 1, kDiffers = 64, kError = 128;

// Hands all on, and counts.
class Counting final : public Engine {
public:
    explicit Counting(std::unique_ptr<Engine> engine) : engine_(std::move(engine)) {}

    EngineReport report() const override { return engine_->report(); }
    EngineTimes run(const EngineWork& work) override {
        const EngineTimes times = engine_->run(work);
        host_updates_ += times.host_updates;
        return times;
    }
    /// Since the last call.
    std::uint64_t host_updates() { return std::exchange(host_updates_, 0); }

private:
    std::unique_ptr<Engine> engine_;
    std::uint64_t host_updates_ = 0;
};

std::unique_ptr<Engine> software_engine(bool twice) {
    EngineOptions options;
    options.gpu = "llvmpipe";
    options.needs_f64 = true;
    options.twice = twice;
    return make_engine(options);
}

bool passes(Engine& engine, const Kernel& kernel, const PreparedCase& scene) {
    return kernel.paths ? compare_paths(engine, scene, kernel.precision).passed
                        : compare_case(engine, scene, kernel.precision).passed;
}

void replace(const Kernel& kernel, Words words) {
    replaced = kernel.words.data();
    replacement = std::move(words);
}

// From here on the process may take so many seconds of processor time; then it is ended.
void limit_time(unsigned seconds) {
    rusage used{};
    getrusage(RUSAGE_SELF, &used);
    const auto end = static_cast<rlim_t>(used.ru_utime.tv_sec + used.ru_stime.tv_sec + 2) + seconds;
    const rlimit limit{end, RLIM_INFINITY};
    setrlimit(RLIMIT_CPU, &limit);
}

int run_trial(const Kernel& kernel, const std::vector<PreparedCase>& scenes, Trial trial, unsigned seconds) {
    replace(kernel, std::move(trial.words));
    std::size_t at = trial.scenes.front();
    try {
        Counting engine(software_engine(true));
        bool left_to_host = false;
        for (const std::size_t scene : trial.scenes) {
            at = scene;
            limit_time(seconds);
            if (!passes(engine, kernel, scenes[scene]))
                return kDiffers + static_cast<int>(scene);
            left_to_host = left_to_host || engine.host_updates() != trial.host_updates[scene];
        }
        return left_to_host ? kLeftToHost : kSurvived;
    } catch (const std::exception&) {
        return kError + static_cast<int>(at);
    }
}

// Forks; the child does `work`, ends with what that returns and says nothing.
pid_t begin_process(const std::function<int()>& work) {
    const pid_t child = fork();
    if (child < 0)
        throw std::runtime_error(fmt::format("no process can be started: {}", std::strerror(errno)));
    if (child != 0)
        return child;
    const rlimit none{0, 0};
    setrlimit(RLIMIT_CORE, &none);
    const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
    dup2(nowhere, STDOUT_FILENO);
    dup2(nowhere, STDERR_FILENO);
    _exit(work());
}

Outcome outcome_of(int status, bool late) {
    if (WIFEXITED(status)) {
        const int code = WEXITSTATUS(status);
        if (code == kSurvived || code == kLeftToHost)
            return {End::survived, code == kLeftToHost, 0};
        if (code >= kError)
            return {End::error, false, static_cast<std::size_t>(code - kError)};
        if (code >= kDiffers)
            return {End::differs, false, static_cast<std::size_t>(code - kDiffers)};
        return {End::crash, false, 0}; // a driver that exits
    }
    const int signal = WTERMSIG(status);
    return {late || signal == SIGXCPU || signal == SIGKILL ? End::time : End::crash, false, 0};
}

} // namespace

void try_kernels(const Kernel& kernel, const std::vector<PreparedCase>& scenes, std::size_t trials,
                 const std::function<Trial(std::size_t)>& trial,
                 const std::function<void(std::size_t, const Outcome&)>& done, unsigned jobs, unsigned seconds) {
    using Clock = std::chrono::steady_clock;
    struct Running {
        std::size_t trial;
        Clock::time_point end;
        bool late = false;
    };
    std::map<pid_t, Running> running;
    for (std::size_t next = 0; next < trials || !running.empty();) {
        if (next < trials && running.size() < jobs) {
            const Trial one = trial(next);
            if (one.scenes.empty()) {
                done(next++, {});
                continue;
            }
            const pid_t child = begin_process([&] { return run_trial(kernel, scenes, one, seconds); });
            running[child] = {next++, Clock::now() + kLongest};
            continue;
        }
        int status = 0;
        for (auto it = running.begin(); it != running.end();) {
            if (waitpid(it->first, &status, WNOHANG) == it->first) {
                done(it->second.trial, outcome_of(status, it->second.late));
                it = running.erase(it);
                continue;
            }
            if (Clock::now() > it->second.end && !std::exchange(it->second.late, true))
                kill(it->first, SIGKILL);
            ++it;
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
}

namespace {

// Reads the marks where a comparison expects results, and hands none of those on.
class Marks final : public Engine {
public:
    Marks(std::unique_ptr<Engine> engine, layout::uint channel, std::size_t stride, std::size_t blocks)
        : engine_(std::move(engine)), channel_(channel), stride_(stride), ran_(blocks, 0) {}

    EngineReport report() const override { return engine_->report(); }
    EngineTimes run(const EngineWork& work) override {
        return std::visit([&](const auto& one) { return run_one(one); }, work);
    }
    const std::vector<char>& ran() const { return ran_; }

private:
    template <typename T> EngineTimes run_one(const FieldWork<T>& work) {
        const auto look = [&](const layout::FieldChunk<T>& chunk) { read(std::as_bytes(chunk.force)); };
        return engine_->evaluate(work.input, look);
    }
    template <typename T> EngineTimes run_one(const PathWork<T>& work) {
        const auto look = [&](const layout::PathChunk<T>& chunk) {
            read(std::as_bytes(channel_ == layout::kChannelPosition ? chunk.position : chunk.force));
        };
        return engine_->explore(work.input, look, [](std::size_t, std::span<const layout::PathMetrics<T>>) {});
    }

    void read(std::span<const std::byte> bytes) {
        const std::size_t size = stride_ * sizeof(std::uint32_t);
        if (bytes.size() < ran_.size() * size)
            throw std::runtime_error("too few samples");
        for (std::size_t i = 0; i < ran_.size(); ++i) {
            std::uint32_t word = 0;
            std::memcpy(&word, bytes.data() + i * size, sizeof(word));
            if (word == kCovered)
                ran_[i] = 1;
        }
    }

    std::unique_ptr<Engine> engine_;
    layout::uint channel_;
    std::size_t stride_; // words
    std::vector<char> ran_;
};

// What `work` returns in a process of its own, as the parent must not start threads. \throws std::runtime_error with
// what went wrong there, after `doing`.
std::string in_process(const std::string& doing, const std::function<std::string()>& work) {
    std::array<int, 2> ends{};
    if (pipe(ends.data()) != 0)
        throw std::runtime_error("no pipe");
    const pid_t child = begin_process([&] {
        std::string text;
        bool done = false;
        try {
            text = work();
            done = true;
        } catch (const std::exception& error) {
            text = error.what();
        }
        return write(ends[1], text.data(), text.size()) == ssize_t(text.size()) && done ? 0 : 1;
    });
    close(ends[1]);
    std::string result;
    std::array<char, 4096> some{};
    for (ssize_t got = 0; (got = read(ends[0], some.data(), some.size())) > 0;)
        result.append(some.data(), std::size_t(got));
    close(ends[0]);
    int status = 0;
    waitpid(child, &status, 0);
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
        throw std::runtime_error(doing + ": " + result);
    return result;
}

std::vector<bool> blocks_that_run(const Kernel& kernel, const KernelCode& code, const PreparedCase& scene,
                                  const std::vector<std::size_t>& blocks) {
    const std::string ran = in_process(fmt::format("which blocks of {} run in {}", kernel.name, scene.one.name), [&] {
        replace(kernel, with_coverage(code, kernel.marks, blocks));
        Marks marks(software_engine(false), kernel.channel, coverage_stride(code, kernel.marks), blocks.size());
        passes(marks, kernel, scene);
        return std::string(marks.ran().begin(), marks.ran().end());
    });
    std::vector<bool> all(code.blocks().size(), false);
    for (std::size_t i = 0; i < blocks.size(); ++i)
        all[blocks[i]] = ran[i] != 0;
    return all;
}

} // namespace

std::vector<std::uint64_t> host_updates_of(const Kernel& kernel, const std::vector<PreparedCase>& scenes) {
    std::vector<std::uint64_t> all(scenes.size(), 0);
    for (std::size_t i = 0; i < scenes.size(); ++i)
        if (is_for(kernel, scenes[i]))
            all[i] =
                std::stoull(in_process(fmt::format("the intact kernel {} in {}", kernel.name, scenes[i].one.name), [&] {
                    Counting engine(software_engine(true));
                    if (!passes(engine, kernel, scenes[i]))
                        throw std::runtime_error("the comparison fails");
                    return std::to_string(engine.host_updates());
                }));
    return all;
}

std::vector<std::vector<bool>> coverage_of(const Kernel& kernel, const KernelCode& code,
                                           const std::vector<PreparedCase>& scenes,
                                           const std::vector<std::size_t>& blocks) {
    std::vector<std::vector<bool>> all;
    for (const PreparedCase& scene : scenes)
        all.push_back(is_for(kernel, scene) ? blocks_that_run(kernel, code, scene, blocks)
                                            : std::vector<bool>(code.blocks().size(), false));
    return all;
}

} // namespace mutation
} // namespace forceshade
