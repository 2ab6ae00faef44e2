#include "host/python/arrays.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include <fmt/format.h>
#include <unistd.h>

#include "host/error.h"
#include "host/mesh/mesh_file.h"
#include "host/numbers.h"
#include "host/output/exr_volume.h"
#include "host/output/rows.h"
#include "host/paths/path_files.h"
#include "host/paths/scene_paths.h"
#include "host/reference/chunks.h"

namespace forceshade::python {
namespace {

// Ctrl-C ends long work. Called without Python's lock.
void check_signals() {
    const py::gil_scoped_acquire lock;
    if (PyErr_CheckSignals() != 0)
        throw py::error_already_set();
}

// Where the machine would sooner be out of memory than out of addresses.
void require_memory_for(const std::string& what, double bytes) {
    const double memory = double(sysconf(_SC_PHYS_PAGES)) * double(sysconf(_SC_PAGESIZE));
    if (!(bytes <= memory)) {
        PyErr_SetString(PyExc_MemoryError, fmt::format("{} take {}, this machine has {}", what,
                                                       numbers::size_text(bytes), numbers::size_text(memory))
                                               .c_str());
        throw py::error_already_set();
    }
}

template <typename Value> using Array = py::array_t<Value, py::array::c_style>;
using Shape = std::vector<py::ssize_t>;

// The array of a channel. An id is a number of 31 bits, and kNoFacet, read as int32, is -1. Places that are measured
// from an origin, m, other than 0 become doubles of the world.
template <typename Value> class Channel {
public:
    using Stored = std::conditional_t<std::is_same_v<Value, layout::uint>, std::int32_t, Value>;

    Channel(py::dict& into, std::uint32_t channel, Shape shape, const glm::dvec3& origin = glm::dvec3(0))
        : components_(components_of(channel)), origin_(origin) {
        if (components_ > 1)
            shape.push_back(py::ssize_t(components_));
        const auto make = [&]<typename Number>(Number*& data) {
            Array<Number> array(shape);
            data = array.mutable_data();
            into[name_of_channel(channel)] = array;
        };
        if (is_moved(channel, origin))
            make(moved_);
        else
            make(data_);
    }

    // Values from sample `first` on.
    void put(std::size_t first, std::span<const Value> values) {
        if (moved_)
            std::ranges::copy(in_world(values, origin_), moved_ + first * components_);
        else
            std::ranges::transform(values, data_ + first * components_,
                                   [](Value value) { return static_cast<Stored>(value); });
    }
    void put(std::size_t sample, const reference::Vector<Value>& vector) {
        const Value values[] = {vector.x, vector.y, vector.z};
        put(sample, values);
    }
    void put(std::size_t sample, Value value) { put(sample, std::span<const Value>(&value, 1)); }
    std::size_t components() const { return components_; }

private:
    std::size_t components_;
    glm::dvec3 origin_; /* m */
    Stored* data_ = nullptr;
    double* moved_ = nullptr;
};

// Contacts of single probes.
template <typename T> struct ContactArrays {
    ContactArrays(py::dict& into, std::size_t count, const glm::dvec3& origin)
        : force(into, layout::kChannelForce, shape(count)), unshaded(into, layout::kChannelUnshaded, shape(count)),
          proxy(into, layout::kChannelProxy, shape(count), origin), depth(into, layout::kChannelDepth, shape(count)),
          facet(into, layout::kChannelFacet, shape(count)) {}

    void put(std::size_t i, const reference::Contact<T>& contact) {
        force.put(i, contact.force);
        unshaded.put(i, contact.unshaded);
        proxy.put(i, contact.proxy);
        depth.put(i, contact.depth);
        facet.put(i, contact.facet);
    }

    static Shape shape(std::size_t count) { return {py::ssize_t(count)}; }
    Channel<T> force, unshaded, proxy, depth;
    Channel<layout::uint> facet;
};

template <typename T> std::span<const glm::dvec3> checked(const Points& points, const PreparedCase& prepared) {
    if (points.ndim() != 2 || points.shape(1) != 3)
        throw UsageError("points are an array of shape (n, 3), in metres");
    const std::span<const glm::dvec3> all(reinterpret_cast<const glm::dvec3*>(points.data()),
                                          std::size_t(points.shape(0)));
    const double largest = largest_coordinate<T>(prepared);
    for (std::size_t i = 0; i < all.size(); ++i) {
        const glm::dvec3& point = all[i];
        if (!(std::abs(point.x) <= largest && std::abs(point.y) <= largest && std::abs(point.z) <= largest))
            throw UsageError("points[{}] = ({}, {}, {}) m: coordinates are numbers of up to {:.3g} m", i, point.x,
                             point.y, point.z, largest);
    }
    return all;
}

// m: where the samples of a grid are.
void add_axes(py::dict& into, const GridSpec& grid) {
    for (std::size_t i = 0; i < 3; ++i) {
        Array<double> axis(static_cast<py::ssize_t>(grid.size[i]));
        for (std::uint64_t j = 0; j < grid.size[i]; ++j)
            axis.mutable_at(py::ssize_t(j)) = grid.at(i, j);
        into[py::str(std::string(1, "xyz"[i]))] = axis;
    }
}

std::uint32_t channels_named(const std::vector<std::string>& names) {
    std::uint32_t channels = layout::kChannelForce;
    for (const std::string& name : names) {
        std::uint32_t channel = layout::kChannelForce;
        while (channel <= layout::kChannelUnshaded && name != name_of_channel(channel))
            channel *= 2;
        if (channel > layout::kChannelUnshaded)
            throw UsageError("no channel \"{}\": there are force, depth, facet, proxy and unshaded", name);
        channels |= channel;
    }
    return channels;
}

using forceshade::ids_of;
template <typename T> std::span<const layout::uint> ids_of(const PathRows<T>& rows) {
    return rows.facet;
}

// Channels of a field or of paths, filled part by part.
template <typename T> class SampleArrays {
public:
    SampleArrays(py::dict& into, std::uint32_t channels, const Shape& shape, const glm::dvec3& origin) {
        for (const std::uint32_t channel : {layout::kChannelPosition, layout::kChannelForce, layout::kChannelDepth,
                                            layout::kChannelUnshaded, layout::kChannelProxy})
            if (channels & channel)
                reals_.emplace_back(channel, Channel<T>(into, channel, shape, origin));
        if (channels & layout::kChannelFacet)
            facet_.emplace(into, layout::kChannelFacet, shape);
    }

    // From sample `to` on `count` samples of a chunk or of rows, from their sample `from` on.
    template <typename Samples> void put(std::size_t to, const Samples& samples, std::size_t from, std::size_t count) {
        for (auto& [channel, array] : reals_)
            array.put(to, values_of(samples, channel).subspan(from * array.components(), count * array.components()));
        if (facet_)
            facet_->put(to, ids_of(samples).subspan(from, count));
    }
    // NaN, and no facet.
    void put_nothing(std::size_t to) {
        constexpr T kNaN = std::numeric_limits<T>::quiet_NaN();
        const T missing[] = {kNaN, kNaN, kNaN};
        for (auto& [channel, array] : reals_)
            array.put(to, std::span(missing).first(array.components()));
        if (facet_)
            facet_->put(to, layout::kNoFacet);
    }

private:
    std::vector<std::pair<std::uint32_t, Channel<T>>> reals_;
    std::optional<Channel<layout::uint>> facet_;
};

} // namespace

PreparedScene::PreparedScene(const std::string& text, const std::string& name, const std::string& folder,
                             const std::vector<Override>& overrides, const std::optional<MeshArrays>& mesh) {
    const Case one = parse_scene(text, name, folder, overrides, &warnings_);
    std::optional<PolygonFile> polygons;
    if (mesh) {
        const auto& [vertices, corners, counts] = *mesh;
        const auto* first = reinterpret_cast<const glm::dvec3*>(vertices.data());
        polygons = polygons_of("mesh", {first, first + vertices.shape(0)},
                               {corners.data(), static_cast<std::size_t>(corners.size())},
                               std::vector<std::size_t>(counts.data(), counts.data() + counts.size()),
                               one.scene.surface.mesh.normals == NormalWeights::file);
    }
    const py::gil_scoped_release release;
    std::string why;
    prepared_ = CasePreparation().prepare_open(one, why, polygons ? &*polygons : nullptr);
    if (!why.empty())
        warnings_.push_back(why + " ({\"run.precision\": \"f32\"} takes it all the same)");
    std::ranges::copy(prepared_.warnings, std::back_inserter(warnings_));
    in_precision(prepared_.one.scene.precision,
                 [&]<typename T>(std::type_identity<T>) { law_ = CaseLaw<T>(prepared_); });
    if (compares())
        comparison_.emplace(prepared_);
}

py::dict PreparedScene::field(const std::vector<std::string>& channels, const EngineOptions& options) const {
    PreparedCase prepared = prepared_;
    Scene& scene = prepared.one.scene;
    if (!scene.field)
        throw UsageError("this scene has [paths] and no [grid], so it has no field: add a [grid], or explore it");
    if (!channels.empty())
        scene.output.channels = channels_named(channels);
    py::dict result;
    add_axes(result, scene.grid);
    in_precision(scene.precision, [&]<typename T>(std::type_identity<T>) {
        const FieldTables<T> tables = make_tables<T>(scene, prepared.images, Extent::what_varies);
        const layout::FieldInput<T> input = tables.input();
        const std::uint32_t wanted = tables.features.channels;
        const std::size_t samples = input.x.size() * input.y.size() * input.z.size();
        std::size_t reals = 0;
        for (std::uint32_t channel = 1; channel <= layout::kChannelUnshaded; channel *= 2)
            reals += wanted & channel ? components_of(channel) : 0;
        require_memory_for(fmt::format("{} samples", samples), double(samples) * double(reals * sizeof(T)));
        const std::size_t ny = input.y.size(), nx = input.x.size();
        SampleArrays<T> arrays(result, wanted, {py::ssize_t(input.z.size()), py::ssize_t(ny), py::ssize_t(nx)},
                               scene_origin(prepared));
        const py::gil_scoped_release release;
        make_engine(options)->evaluate<T>(input, [&](const layout::FieldChunk<T>& chunk) {
            for (std::size_t z = 0; z < chunk.z_count; ++z)
                for (std::size_t y = 0; y < chunk.y_count; ++y)
                    arrays.put(((chunk.z_first + z) * ny + chunk.y_first + y) * nx, chunk,
                               (z * chunk.y_count + y) * chunk.x_pitch, nx);
            check_signals();
        });
    });
    return result;
}

namespace {

// evaluate(i, hint) for every place, without Python's lock; a hint goes from place to place.
template <typename Evaluate> void at_every_place(std::size_t places, unsigned threads, const Evaluate& evaluate) {
    constexpr std::size_t kShare = 1024, kBetweenSignals = std::size_t(1) << 18;
    const py::gil_scoped_release release;
    for (std::size_t first = 0; first < places; first += kBetweenSignals) {
        const std::size_t count = std::min(kBetweenSignals, places - first);
        const auto evaluate_share = [&](std::size_t, std::size_t share) {
            layout::uint hint = 0;
            const std::size_t begin = first + share * kShare, end = std::min(begin + kShare, first + count);
            for (std::size_t i = begin; i < end; ++i)
                evaluate(i, hint);
        };
        reference::share_out(std::min<std::size_t>(reference::threads_for(threads), count / kShare + 1),
                             (count + kShare - 1) / kShare, evaluate_share);
        check_signals();
    }
}

} // namespace

py::dict PreparedScene::compare(const Points& points, const Points& forces, unsigned threads) const {
    py::dict result;
    const auto compare = [&]<typename T>(const CaseLaw<T>&) {
        const std::span<const glm::dvec3> all = checked<T>(points, prepared_);
        const auto* force = reinterpret_cast<const glm::dvec3*>(forces.data());
        const Shape shape{py::ssize_t(all.size())};
        Channel<T> angle(result, kChannelAngle, shape), error(result, kChannelMagnitudeError, shape);
        at_every_place(all.size(), threads, [&](std::size_t i, layout::uint& hint) {
            const Deviation one = comparison_->at(all[i], force[i], hint);
            angle.put(i, static_cast<T>(one.angle));
            error.put(i, static_cast<T>(one.magnitude_error));
        });
    };
    std::visit(compare, *law_);
    return result;
}

py::dict PreparedScene::contact(const Points& points, unsigned threads) const {
    py::dict result;
    const auto evaluate = [&]<typename T>(const CaseLaw<T>& law) {
        const std::span<const glm::dvec3> all = checked<T>(points, prepared_);
        ContactArrays<T> arrays(result, all.size(), law.origin());
        at_every_place(all.size(), threads,
                       [&](std::size_t i, layout::uint& hint) { arrays.put(i, law.at(all[i], hint)); });
    };
    std::visit(evaluate, *law_);
    return result;
}

namespace {

// All samples of paths, by path, and a row of figures each.
template <typename T> class PathArrays {
public:
    PathArrays(py::dict& into, std::uint32_t channels, std::size_t paths, std::size_t steps, const glm::dvec3& origin)
        : steps_(steps), samples_(into, channels, {py::ssize_t(paths), py::ssize_t(steps)}, origin) {
        py::dict figures;
        for_each_figure(0, {}, [&](const char* name, const auto&) {
            Array<double> column(static_cast<py::ssize_t>(paths));
            columns_.push_back(column.mutable_data());
            figures[name] = column;
        });
        into["figures"] = figures;
    }

    void put(const PathRows<T>& rows) {
        for (std::size_t path = 0; path < rows.path_count; ++path) {
            const std::size_t count = rows.samples(path), end = (rows.path_first + path + 1) * steps_;
            const std::size_t to = end - steps_ + rows.step_first;
            samples_.put(to, rows, path * rows.pitch, count);
            for (std::size_t rest = to + count; rows.ends(path) && rest < end; ++rest)
                samples_.put_nothing(rest);
        }
    }

    void put(std::size_t path, const PathFigures& figures) {
        std::size_t column = 0;
        for_each_figure(path, figures, [&]<typename Value>(const char*, const Value& value) {
            double& cell = columns_[column++][path];
            if constexpr (std::is_same_v<Value, SampleTime>)
                cell = value.seconds.value_or(kNaN);
            else if constexpr (std::is_same_v<Value, std::optional<double>>)
                cell = double(T(value.value_or(kNaN)));
            else
                cell = double(value);
        });
    }

private:
    static constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

    std::size_t steps_;
    SampleArrays<T> samples_;
    std::vector<double*> columns_; // of the figures
};

std::vector<std::vector<glm::dvec3>> positions_of(const std::vector<Points>& paths) {
    std::vector<std::vector<glm::dvec3>> result;
    for (std::size_t path = 0; path < paths.size(); ++path) {
        const Points& points = paths[path];
        if (points.ndim() != 2 || points.shape(1) != 3)
            throw UsageError("paths[{}] is no array of shape (steps, 3), in metres", path);
        const auto* first = reinterpret_cast<const glm::dvec3*>(points.data());
        result.emplace_back(first, first + points.shape(0));
    }
    return result;
}

} // namespace

py::dict PreparedScene::explore(const std::optional<std::vector<Points>>& given, EngineOptions options) const {
    const Scene& scene = prepared_.one.scene;
    const double rate = scene.paths ? scene.paths->rate : PathsSpec{}.rate;
    constexpr std::uint32_t kChannels = layout::kChannelForce | layout::kChannelPosition | layout::kChannelDepth |
                                        layout::kChannelFacet | layout::kChannelProxy;
    py::dict result;
    result["rate"] = rate;
    in_precision(scene.precision, [&]<typename T>(std::type_identity<T>) {
        std::shared_ptr<const RecordedFile> recorded;
        if (given)
            recorded = std::make_shared<const RecordedFile>(
                "paths", positions_of(*given), RecordedOptions{.largest_coordinate = largest_coordinate<T>(prepared_)});
        ScenePaths<T> paths(prepared_, recorded);
        layout::PathInput<T> input = paths.input();
        input.features.channels = kChannels;
        require_memory_for(fmt::format("{} paths of {} steps", input.paths, input.steps),
                           double(input.paths) * double(input.steps) * double(path_sample_bytes(kChannels, sizeof(T))));
        PathArrays<T> arrays(result, kChannels, input.paths, input.steps, scene_origin(prepared_));
        const py::gil_scoped_release release;
        BatchedSource<T> source(paths, input.steps, paths_that_fit(input));
        input.source = &source;
        paths.limit_batches(samples_that_fit(input));
        RowGatherer<T> gatherer(source, [&](const PathRows<T>& rows) { arrays.put(rows); });
        const bool closed = input.features.loop == layout::kLoopClosed;
        make_engine(options)->explore<T>(
            input,
            [&](const layout::PathChunk<T>& chunk) {
                gatherer.add(chunk);
                check_signals();
            },
            [&](std::size_t first, std::span<const layout::PathMetrics<T>> metrics) {
                for (std::size_t i = 0; i < metrics.size(); ++i) {
                    const bool inside = !source.inside().empty() && source.inside()[i];
                    arrays.put(first + i, figures_of(metrics[i], {source.lengths()[i], rate, closed, inside}));
                }
            });
    });
    return result;
}

GodObject::GodObject(std::shared_ptr<const PreparedScene> scene) : scene_(std::move(scene)) {
    const PreparedCase& prepared = scene_->prepared();
    in_precision(prepared.one.scene.precision,
                 [&]<typename T>(std::type_identity<T>) { probe_ = std::make_unique<CaseProbe<T>>(prepared); });
}

void GodObject::reset() {
    std::visit([](const auto& probe) { probe->begin_path(); }, probe_);
}

py::dict GodObject::follow(const Points& points) {
    py::dict result;
    const auto run = [&]<typename T>(const Probe<T>& probe) {
        const std::span<const glm::dvec3> all = checked<T>(points, scene_->prepared());
        ContactArrays<T> arrays(result, all.size(), probe->law().origin());
        constexpr std::size_t kBetweenSignals = std::size_t(1) << 16;
        const py::gil_scoped_release release;
        for (std::size_t i = 0; i < all.size(); ++i) {
            if (!probe->law().reaches(all[i]))
                throw UsageError(beyond_reach<T>(all[i]));
            arrays.put(i, probe->at(all[i]).contact);
            if (i % kBetweenSignals == kBetweenSignals - 1)
                check_signals();
        }
    };
    std::visit(run, probe_);
    return result;
}

namespace {

template <typename Value>
void add(py::dict& into, std::uint32_t channel, const Shape& shape, const std::vector<Value>& values,
         const glm::dvec3& origin = glm::dvec3(0)) {
    if (!values.empty())
        Channel<Value>(into, channel, shape, origin).put(0, std::span<const Value>(values));
}

// Hz: of the scene's own paths; NaN where there are none.
double rate_of(const std::string& scene) {
    const std::optional<Case> one = stated_scene(scene);
    const bool own = one && one->scene.paths && one->scene.paths->kind != PathKind::recorded;
    return own ? one->scene.paths->rate : std::numeric_limits<double>::quiet_NaN();
}

py::dict read_field(const std::string& file) {
    VolumeReader reader(file);
    const VolumeHeader& header = reader.header();
    const auto [nx, ny, nz] = header.size;
    const Shape shape{py::ssize_t(nz), py::ssize_t(ny), py::ssize_t(nx)};
    py::dict result;
    add_axes(result, {header.size, header.origin, header.spacing});
    result["scene"] = header.scene;
    for (const std::uint32_t channel : kFieldChannels) {
        if (!(header.channels & channel))
            continue;
        constexpr std::uint64_t kRows = 4096;
        const auto read = [&]<typename Value>(std::vector<Value> values, auto rows) {
            Channel<Value> array(result, channel, shape, header.place_origin);
            const py::gil_scoped_release release;
            for (std::uint64_t first = 0; first < reader.rows(); first += kRows) {
                rows(first, std::min(kRows, reader.rows() - first), values);
                array.put(first * nx, std::span<const Value>(values));
                check_signals();
            }
        };
        if (channel == layout::kChannelFacet)
            read(std::vector<std::uint32_t>(),
                 [&](auto first, auto count, auto& ids) { reader.read_ids(first, count, ids); });
        else
            read(std::vector<float>(),
                 [&](auto first, auto count, auto& values) { reader.read(channel, first, count, values); });
    }
    return result;
}

} // namespace

py::dict read_exr(const std::string& file) {
    if (!holds_paths(file))
        return read_field(file);
    constexpr std::uint64_t kAll = std::uint64_t(1) << 40;
    const PathSamples read = read_paths(file, kAll, kAll, true);
    const Shape shape{py::ssize_t(read.paths), py::ssize_t(read.steps)};
    py::dict result;
    add(result, layout::kChannelForce, shape, read.force);
    add(result, layout::kChannelPosition, shape, read.position, read.origin);
    add(result, layout::kChannelProxy, shape, read.proxy, read.origin);
    add(result, layout::kChannelDepth, shape, read.depth);
    add(result, layout::kChannelFacet, shape, read.facet);
    add(result, kChannelAngle, shape, read.angle);
    add(result, kChannelMagnitudeError, shape, read.magnitude_error);
    result["scene"] = read.scene;
    result["rate"] = rate_of(read.scene);
    return result;
}

} // namespace forceshade::python
