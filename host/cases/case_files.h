// The files that a case leaves, of a field or of paths: their names, what is asked for; what writes them together, with
// the comparison of [compare] and pictures; and the record that lists them all.
#pragma once

#include <algorithm>
#include <array>
#include <filesystem>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "host/field/comparison.h"
#include "host/field/prepared_case.h"
#include "host/output/exr_volume.h"
#include "host/output/record.h"
#include "host/output/rows.h"
#include "host/picture/picture.h"
#include "host/program.h"

namespace forceshade {

/// The files that a case leaves in addition to its EXR.
struct AlsoFormats {
    static constexpr std::array kNames{"vti", "vtp", "npy", "png", "svg", "pdf"};
    bool vti = false, vtp = false, npy = false;
    picture::Endings pictures{};

    /// False if there is no such format.
    bool add(std::string_view name) {
        if (name == "vti")
            return vti = true;
        if (name == "vtp")
            return vtp = true;
        if (name == "npy")
            return npy = true;
        return pictures.add(name);
    }
};

/// What a channel's file has after the stem: ".force.npy".
inline std::string npy_kind(layout::uint channel) {
    return fmt::format(".{}.npy", name_of_channel(channel));
}

/// \throws UsageError for a name that is none of vti, vtp, npy, png, svg, pdf.
AlsoFormats parse_also(const std::vector<std::string>& names);

/// Whether its mesh is drawn under all shadings: once for a mesh, and so not for each stiffness or shading of a study.
inline bool draws_turns(const Case& one) {
    return one.scene.surface.kind == SurfaceKind::mesh && one.first_of_surface;
}
/// The names of all files that a case leaves whose volume is or would be called `STEM.exr`, the volume first.
std::vector<std::string> file_names(const std::string& stem, const Case& one, AlsoFormats also);
/// Every name that a case may leave.
std::vector<std::string> possible_file_names(const std::string& stem, AlsoFormats also);

/// Attributes and compression of the EXR of a case's field or paths; `written`: the part of the scene that it holds.
void set_options(ExrOptions& options, const PreparedCase& prepared, const Scene& written, int threads);

/// The record of a case without what is computed.
CaseRecord empty_record(const PreparedCase& prepared);

/// "left out: 94 % of the voxels (15 of 16 y samples, alike); shading, texture; channels depth, facet (2 numbers a
/// voxel)": what the scene did not need.
std::string left_out_text(const CaseRecord& record);
/// The same of a scene of paths alone, with the channels that their samples have.
std::string left_out_text(const Scene& paths);

/// A published file.
template <typename Record> void add_file(Record& record, const std::string& name, const VolumeResult& result) {
    record.files.push_back({name, result.sha256, result.bytes});
    record.volume_times += result.timings;
}

/// Sink: ChunkSink of a field or PathSink of paths. Files are published in the order in which they were opened.
template <typename Sink> class CaseOutput {
public:
    /// `stem`: FOLDER/NAME, with which all names begin. `threads`: for [compare], if the scene has it and `compares`.
    CaseOutput(const PreparedCase& prepared, std::filesystem::path stem, const picture::Endings& pictures,
               const picture::Look& look, unsigned threads, bool compares = true)
        : prepared_(prepared), stem_(std::move(stem)), pictures_(pictures), look_(look) {
        if (prepared.one.scene.compare && compares)
            compared_.emplace(prepared, threads);
    }

    const PreparedCase& prepared() const { return prepared_; }
    const Scene& scene() const { return prepared_.one.scene; }
    /// STEM.kind
    std::filesystem::path path_of(const std::string& kind) const { return stem_.string() + kind; }
    Compared* compared() { return compared_ ? &*compared_ : nullptr; }

    /// One more file, which the arguments describe.
    template <typename Writer, typename... Arguments>
    void open(const std::filesystem::path& file, const Arguments&... arguments) {
        sinks_.emplace_back(file.filename().string(), std::make_unique<Writer>(file, arguments...));
    }
    /// What the sinks take. \throws what they throw, Interrupted.
    template <typename... Rows> void write(const Rows&... rows) {
        for (const auto& [name, sink] : sinks_) {
            check_interrupt();
            sink->write(rows...);
        }
    }

    /// Publishes the first file, which refuses what must not be published, and adds it to a CaseRecord or PathRecord.
    template <typename Record> VolumeResult finish_first(Record& record) { return finish(sinks_.at(next_++), record); }
    /// Then the others; and what [compare] says.
    template <typename Record> void finish_others(Record& record) {
        while (next_ < sinks_.size())
            finish(sinks_[next_++], record);
        if (compared_)
            record.deviation = compared_->record();
    }

    /// How a picture of it looks; without a title of its own that.
    picture::Look look(const std::string& title) const {
        picture::Look titled = look_;
        if (titled.title.empty())
            titled.title = title;
        return titled;
    }
    /// Writes a picture, STEM.kind.png and so on.
    template <typename Record> void draw(const std::string& kind, const picture::Picture& drawn, Record& record) const {
        std::ranges::move(picture::write_picture(path_of(kind), pictures_, drawn), std::back_inserter(record.files));
    }

private:
    using Named = std::pair<std::string, std::unique_ptr<Sink>>;

    template <typename Record> static VolumeResult finish(Named& one, Record& record) {
        VolumeResult result = one.second->finish();
        add_file(record, one.first, result);
        return result;
    }

    const PreparedCase& prepared_;
    std::filesystem::path stem_;
    picture::Endings pictures_;
    picture::Look look_;
    std::vector<Named> sinks_;
    std::size_t next_ = 0;             // to be published
    std::optional<Compared> compared_; // with [compare]
};

// The surface of a scene with the forces on it, as polygons for ParaView (.vtp).
//
// The force of a point is what a probe feels that touches the surface there and is pressed 1 mm deep, against a mesh's
// facet along its normal, elsewhere straight down; by the law in the run's precision, and once more without shading.
//
// Forces stand on points, and each facet has points of its own at its corners, where the law is that of this facet. So
// an unshaded force is the same all over a facet and jumps at its edges, and a shaded one turns within the facet, as it
// is displayed. A cell has one number for a whole facet: of the paper's bump of one facet, at whose middle shading
// changes nothing, it would show nothing.

/// Polygons in m, in the world's frame; points have `force` (N, the active vector), `unshaded` (N), `turn` (deg,
/// between the two: by how much shading turns the force) and with [compare] `angle` (deg) and `magnitude_error` (N);
/// cells have `facet`, and the whole has `pressed_m`. `turn` is that of the point: in the middle of a mesh's facet it
/// is the angle between the two forces there, not what a viewer makes of the corners' numbers.
/// - A mesh: its facets with all their corners; cell i is facet i. A facet that no probe touches (it has no area, or
///   repeats another) has no force.
/// - A bump: its facets, and the plane on both sides as far as the grid reaches along x, as strips as long as the grid
///   along y. A facet that has shading or texture is cut into several strips. Of more than 1024 facets each polygon
///   stands for several and has the number of the first.
/// - A cylinder bump (facet 0; the plane is 1) and a height map (the plane, on which its forces are felt): sampled at
///   the grid's (x, y), or at 512 places along an axis that has more.
/// Along y nothing is cut where the force does not depend on y. \throws IoError, Interrupted, UsageError if a value
/// leaves the range of the run's precision.
VolumeResult write_surface(const std::filesystem::path& path, const PreparedCase& prepared);

/// By how much `shading` turns the force in the middle of each part of a mesh's triangles, pressed as in write_surface;
/// in double. 0 on a facet that no probe touches; of a facet with more than 256 corners evenly chosen triangles stand
/// for the others. More than one part a triangle where they are few. \throws Interrupted.
picture::TurnedMesh mesh_turns(const PreparedCase& prepared, Shading shading);

/// Bytes of the arrays before they are compressed, at most; of a mesh, which need not have been read, guessed from the
/// size of its file. 0 if there is no such file.
double most_surface_bytes(const Scene& scene);

} // namespace forceshade
