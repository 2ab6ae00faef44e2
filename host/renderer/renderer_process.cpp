#include "host/renderer/renderer_process.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <new>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <system_error>
#include <unistd.h>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "host/clock.h"
#include "host/program.h"
#include "host/reference/path_step.h"
#include "host/renderer/renderer_exchange.h"
#include "host/scene/schema.h"
#include "host/spelling.h"

extern char** environ;

namespace forceshade {

struct RendererProcess::Shared : RendererExchange {};

namespace {

constexpr std::chrono::milliseconds kLook{20};         // from one look at the process to the next
constexpr std::chrono::milliseconds kLongestEnd{2000}; // of fsr_close

std::string system_text(int number) {
    return std::generic_category().message(number);
}

// A file descriptor that its owner closes.
struct Descriptor {
    explicit Descriptor(int opened) : number(opened) {}
    ~Descriptor() {
        if (number >= 0)
            ::close(number);
    }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    int number;
};

// The scene behind the exchange; `at` is where it begins.
void put_scene(RendererExchange& exchange, std::byte* at, const RendererMesh& mesh, const std::string& surface,
               const std::string& toml, const std::string& options) {
    const auto put = [&](const void* from, std::size_t bytes) {
        std::memcpy(at, from, bytes);
        at += bytes;
    };
    exchange.vertex_count = mesh.vertices.size();
    exchange.triangle_count = mesh.triangles.size();
    exchange.surface_bytes = surface.size() + 1;
    exchange.toml_bytes = toml.size() + 1;
    exchange.options_bytes = options.size() + 1;
    put(mesh.vertices.data(), mesh.vertices.size() * sizeof(glm::dvec3));
    put(mesh.triangles.data(), mesh.triangles.size() * sizeof mesh.triangles[0]);
    for (const std::string* text : {&surface, &toml, &options})
        put(text->c_str(), text->size() + 1);
}

pid_t spawn(const std::string& library, int descriptor) {
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, 2, 1); // what a renderer prints is for people
    posix_spawn_file_actions_adddup2(&actions, descriptor, kRendererDescriptor);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    sigset_t none;
    sigemptyset(&none);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setpgroup(&attributes, 0); // a group of its own, which ends with it
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETPGROUP);
    if (std::signal(SIGCHLD, SIG_DFL) == SIG_ERR) // where it is ignored, no one learns how a process ended
        throw IoError("cannot wait for a renderer's process: {}", system_text(errno));
    std::string name = "forceshade", command = kRendererCommand, file = library;
    char* arguments[] = {name.data(), command.data(), file.data(), nullptr};
    pid_t child = -1;
    const int error = posix_spawn(&child, "/proc/self/exe", &actions, &attributes, arguments, environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    if (error != 0)
        throw IoError("cannot start a process for a renderer: {}", system_text(error));
    return child;
}

} // namespace

RendererSource parse_renderer(const std::string& text) {
    std::size_t colon = text.find(':');
    for (std::size_t at = colon; at != std::string::npos; at = text.find(':', at + 1)) // a folder's name may have one
        if (std::error_code error; std::filesystem::is_regular_file(text.substr(0, at), error))
            colon = at;
    if (std::error_code error; std::filesystem::is_regular_file(text, error))
        colon = std::string::npos;
    const std::string file = text.substr(0, colon);
    if (file.empty())
        throw UsageError("--renderer {}: write LIBRARY or LIBRARY:OPTIONS, such as ./libmine.so:fast", text);
    RendererSource source;
    source.library = std::filesystem::absolute(file);
    source.options = colon == std::string::npos ? "" : text.substr(colon + 1);
    if (std::error_code error; !std::filesystem::is_regular_file(source.library, error))
        throw IoError("--renderer {}: there is no file {}; build it first (cc -O2 -shared -fPIC mine.c -o libmine.so)",
                      text, file);
    source.name = source.library.stem().string();
    if (source.name.starts_with("lib") && source.name.size() > 3)
        source.name.erase(0, 3);
    if (!source.options.empty())
        source.name += ":" + source.options;
    source.name = printable(source.name);
    return source;
}

std::vector<RendererSource> parse_renderers(const std::vector<std::string>& texts) {
    std::vector<RendererSource> all;
    for (const std::string& text : texts) {
        RendererSource source = parse_renderer(text);
        const std::string name = source.name;
        for (int number = 2; std::ranges::count(all, source.name, &RendererSource::name) > 0; ++number)
            source.name = fmt::format("{} ({})", name, number);
        all.push_back(std::move(source));
    }
    return all;
}

RendererProcess::RendererProcess(const RendererSource& source, const PreparedCase& prepared, double period,
                                 const RendererPatience& patience)
    : patience_(patience) {
    const RendererMesh mesh = renderer_mesh(prepared);
    const std::string surface = std::string(kSurfaceKinds[std::size_t(prepared.one.scene.surface.kind)]);
    bytes_ = sizeof(Shared) + mesh.vertices.size() * sizeof(glm::dvec3) +
             mesh.triangles.size() * sizeof(std::array<int, 3>) + surface.size() + prepared.scene.size() +
             source.options.size() + 3;
    const Descriptor memory(::memfd_create("forceshade renderer", MFD_CLOEXEC | MFD_ALLOW_SEALING));
    if (memory.number < 0 || ::ftruncate(memory.number, static_cast<off_t>(bytes_)) != 0 ||
        ::fcntl(memory.number, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL) != 0)
        throw IoError("cannot share memory with a renderer: {}", system_text(errno));
    void* const mapped = ::mmap(nullptr, bytes_, PROT_READ | PROT_WRITE, MAP_SHARED, memory.number, 0);
    if (mapped == MAP_FAILED)
        throw IoError("cannot share memory with a renderer: {}", system_text(errno));
    shared_ = new (mapped) Shared{};
    shared_->program = ::getpid();
    ::sem_init(&shared_->request, 1, 0);
    ::sem_init(&shared_->reply, 1, 0);
    shared_->extent = mesh.extent;
    shared_->stiffness = prepared.one.scene.force.stiffness;
    shared_->period = period;
    put_scene(*shared_, reinterpret_cast<std::byte*>(shared_ + 1), mesh, surface, prepared.scene, source.options);
    try {
        child_ = spawn(source.library.string(), memory.number);
        open_ = true;
        ask(kRendererUpdate, patience_.open); // of nothing: it is ready then
    } catch (...) {
        kill();
        ::munmap(shared_, bytes_);
        throw;
    }
}

RendererProcess::~RendererProcess() {
    close();
    ::munmap(shared_, bytes_);
}

// "crashed (Aborted)", or nothing while it runs. It is not reaped yet, so that its number remains its own.
std::string RendererProcess::how_it_ended() const {
    siginfo_t info{};
    if (::waitid(P_PID, static_cast<id_t>(child_), &info, WEXITED | WNOHANG | WNOWAIT) != 0)
        return "ended its process";
    if (info.si_pid == 0)
        return "";
    if (info.si_code == CLD_EXITED)
        return fmt::format("ended its process (exit {})", info.si_status);
    return fmt::format("crashed ({})", ::strsignal(info.si_status));
}

// With the processes that it has begun, but for those that have left its group.
void RendererProcess::kill() noexcept {
    if (child_ > 0) {
        ::kill(-child_, SIGKILL);
        ::waitpid(child_, nullptr, 0);
    }
    child_ = -1;
    open_ = false;
}

std::string RendererProcess::close() noexcept {
    std::string wrong;
    if (open_) {
        shared_->what = kRendererEnd;
        ::sem_post(&shared_->request);
        const Clock::time_point until = Clock::now() + std::min(patience_.update, kLongestEnd);
        std::string ended;
        while ((ended = how_it_ended()).empty() && Clock::now() < until)
            ::usleep(1000);
        if (ended.empty())
            wrong = "did not return from fsr_close";
        else if (shared_->stage == kRendererClosing && ended != "ended its process (exit 0)")
            wrong = ended + where();
    }
    kill();
    return wrong;
}

std::string RendererProcess::where() const {
    switch (shared_->stage) {
    case kRendererLoading:
        return shared_->refused != 0 ? "" : " while it was loaded";
    case kRendererOpening:
        return " in fsr_open";
    case kRendererReady:
        return " between updates";
    case kRendererClosing:
        return " in fsr_close";
    default:
        return fmt::format(" in update {}", updates_ + shared_->done + 1);
    }
}

void RendererProcess::fail(const std::string& what) {
    kill();
    const bool updating = shared_->stage == kRendererUpdating;
    constexpr std::size_t kLongest = 300; // bytes
    throw RendererError(printable(std::string_view(what).substr(0, kLongest)) + where(),
                        updating ? std::optional(updates_ + shared_->done) : std::nullopt);
}

// Has the process do something, and waits until it is done.
void RendererProcess::ask(std::uint32_t what, std::chrono::milliseconds patience) {
    if (!open_)
        throw RendererError("has ended", std::nullopt);
    shared_->what = what;
    shared_->done = 0;
    ::sem_post(&shared_->request);
    Clock::time_point moved = Clock::now();
    std::uint32_t done = 0;
    for (;;) {
        timespec until{};
        ::clock_gettime(CLOCK_MONOTONIC, &until);
        until.tv_nsec += std::chrono::nanoseconds(kLook).count();
        if (until.tv_nsec >= 1000000000) {
            until.tv_nsec -= 1000000000;
            ++until.tv_sec;
        }
        if (::sem_clockwait(&shared_->reply, CLOCK_MONOTONIC, &until) == 0)
            break;
        if (is_interrupted())
            kill();
        check_interrupt();
        if (const std::string ended = how_it_ended(); !ended.empty())
            fail(ended);
        if (shared_->done != done) {
            done = shared_->done;
            moved = Clock::now();
        } else if (Clock::now() - moved > patience) {
            fail(fmt::format("gave no answer within {:.3g} s", std::chrono::duration<double>(patience).count()));
        }
    }
    if (shared_->refused != 0)
        fail(std::string(shared_->text.data(), ::strnlen(shared_->text.data(), shared_->text.size())));
}

void RendererProcess::put(std::size_t item, const glm::dvec3& probe) noexcept {
    for (int axis = 0; axis < 3; ++axis)
        shared_->items[item].probe[axis] = probe[axis];
}

RendererAnswer RendererProcess::answer(std::size_t item) const noexcept {
    const RendererItem& from = shared_->items[item];
    const auto vector = [](const double(&v)[3]) { return glm::dvec3(v[0], v[1], v[2]); };
    const bool has_proxy = from.touch.has_proxy != 0;
    return {vector(from.touch.force), vector(has_proxy ? from.touch.proxy : from.probe), has_proxy, from.seconds};
}

RendererAnswer RendererProcess::update(const glm::dvec3& probe) {
    put(0, probe);
    shared_->count = 1;
    shared_->begins = begins_ ? kRendererBegins : kRendererGoesOn;
    shared_->cold = 0;
    ask(kRendererUpdate, patience_.update);
    begins_ = false;
    ++updates_;
    return answer(0);
}

std::vector<RendererAnswer> RendererProcess::update(std::span<const glm::dvec3> probes, const How& how) {
    std::vector<RendererAnswer> answers;
    answers.reserve(probes.size());
    while (!probes.empty()) {
        check_interrupt();
        const std::span<const glm::dvec3> batch = probes.first(std::min(probes.size(), kRendererBatch));
        for (std::size_t i = 0; i < batch.size(); ++i)
            put(i, batch[i]);
        shared_->count = static_cast<std::uint32_t>(batch.size());
        shared_->begins = how.each_begins ? kRendererEachBegins : begins_ ? kRendererBegins : kRendererGoesOn;
        shared_->cold = how.cold;
        ask(kRendererUpdate, patience_.update);
        begins_ = false;
        for (std::size_t i = 0; i < batch.size(); ++i)
            answers.push_back(answer(i));
        updates_ += batch.size();
        probes = probes.subspan(batch.size());
    }
    return answers;
}

RendererLaw::RendererLaw(const RendererSource& source, const PreparedCase& prepared, double period,
                         std::shared_ptr<std::string> failure)
    : renderer_(source, prepared, period), stiffness_(prepared.one.scene.force.stiffness),
      hand_(prepared.one.scene.hand), failure_(std::move(failure)) {
    scene = scene_id(prepared);
}

bool RendererLaw::reaches(const glm::dvec3& probe) const noexcept {
    return std::isfinite(probe.x) && std::isfinite(probe.y) && std::isfinite(probe.z);
}

ProbeContact RendererLaw::at(const glm::dvec3& probe) noexcept {
    ProbeContact contact{probe, glm::dvec3(NAN), glm::dvec3(NAN), 0, layout::kNoFacet, true};
    if (interrupted_ || !failure_->empty())
        return contact;
    try {
        const RendererAnswer answer = renderer_.update(probe);
        contact.force = answer.force;
        contact.proxy = answer.proxy;
        contact.depth = glm::length(answer.force) / stiffness_;
        contact.coupled = reference::through_coupling(coupling_, answer.force, contact.depth, lag_);
        contact.facet = contact.depth > 0 ? 0 : layout::kNoFacet;
    } catch (const Interrupted&) {
        interrupted_ = true; // which ends the loop
    } catch (const std::exception& error) {
        *failure_ = error.what();
    }
    return contact;
}

} // namespace forceshade
