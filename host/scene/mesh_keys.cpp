#include "host/scene/scene.h"
#include "host/scene/schema_keys.h"
#include "host/scene/setters.h"

namespace forceshade {

namespace {

constexpr std::array<std::string_view, 2> kNormals{"plain", "angle"};
constexpr std::array<std::string_view, 2> kInsideTests{"pseudonormal", "winding"};

void add_transform(std::vector<Key>& keys) {
    keys.push_back({.table = "surface",
                    .name = "transform.scale",
                    .kind = ValueKind::number,
                    .default_text = "1",
                    .doc = "the mesh is made so many times larger, then turned, then moved",
                    .set = [](Scene& s, const Value& v) { s.surface.mesh.scale = v.numbers.at(0); },
                    .subject = Subject::surface,
                    .forms = kFormMesh,
                    .sign = Sign::positive});
    keys.push_back({.table = "surface",
                    .name = "transform.rotate",
                    .kind = ValueKind::quantity,
                    .default_text = "[\"0 deg\", \"0 deg\", \"0 deg\"]",
                    .doc = "turns about the fixed x axis, then y, then z, through the file's origin",
                    .set = [](Scene& s, const Value& v) { s.surface.mesh.rotate = components<3>(v); },
                    .subject = Subject::surface,
                    .forms = kFormMesh,
                    .dimension = Dimension::angle,
                    .count = 3});
    keys.push_back({.table = "surface",
                    .name = "transform.translate",
                    .kind = ValueKind::quantity,
                    .default_text = "[\"0 m\", \"0 m\", \"0 m\"]",
                    .doc = "where the file's origin is put",
                    .set = [](Scene& s, const Value& v) { s.surface.mesh.translate = components<3>(v); },
                    .subject = Subject::surface,
                    .forms = kFormMesh,
                    .count = 3});
}

} // namespace

void add_mesh_keys(std::vector<Key>& keys) {
    keys.push_back({.table = "surface",
                    .name = "unit",
                    .kind = ValueKind::unit,
                    .default_text = "\"m\"",
                    .doc = "what a coordinate of 1 means in the mesh's file, for example \"mm\"",
                    .set = [](Scene& s, const Value& v) { s.surface.mesh.unit = v.numbers.at(0); },
                    .subject = Subject::surface,
                    .forms = kFormMesh,
                    .sign = Sign::positive});
    keys.push_back({.table = "surface",
                    .name = "normals",
                    .kind = ValueKind::choice,
                    .default_text = "\"plain\"",
                    .doc =
                        "a vertex normal is the plain average of its facets' normals, as in the paper, or weighted by "
                        "their angles there, which does not depend on how a face was cut into triangles (L7)",
                    .set = [](Scene& s, const Value& v) { s.surface.mesh.normals = choice<NormalWeights>(v); },
                    .subject = Subject::surface,
                    .forms = kFormMesh,
                    .choices = kNormals});
    keys.push_back({.table = "surface",
                    .name = "inside",
                    .kind = ValueKind::choice,
                    .default_text = "\"pseudonormal\"",
                    .doc =
                        "what tells inside from outside on a grid (L6): the normal of the nearest feature, for closed "
                        "meshes, or the generalized winding number, which also serves meshes with holes",
                    .set = [](Scene& s, const Value& v) { s.surface.mesh.inside = choice<InsideTest>(v); },
                    .subject = Subject::surface,
                    .forms = kFormMesh,
                    .choices = kInsideTests});
    add_transform(keys);
}

} // namespace forceshade
