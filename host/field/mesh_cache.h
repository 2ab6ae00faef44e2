// Prepared meshes kept on disk between runs, since large ones take longer to prepare than to use.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "host/field/prepared_case.h"

namespace forceshade {

/// For the whole process: where prepared meshes of 50 000 triangles and more are kept, up to 2 GiB of them, 1 GiB from
/// one call on; those used the longest ago go first. Empty, so that none are, until it is set.
void keep_meshes_in(const std::filesystem::path& folder);

/// Of the file with this SHA-256, prepared as `spec` has it by this version of the program; null without an intact
/// file of it. \throws UsageError if it needs more memory than is allowed
std::shared_ptr<const SceneMesh> kept_mesh(const MeshSpec& spec, const std::string& sha256);

/// Whether a file is large enough for that, as far as its size says.
bool may_be_kept(const std::filesystem::path& file);

/// Keeps it, if it is large; never throws. `spec` is the one that it was prepared from.
void keep_mesh(const MeshSpec& spec, const SceneMesh& mesh) noexcept;

} // namespace forceshade
