// L6: the god-object on a mesh, in the order in which its parts build on each other. FS_RARE: all of its walk, with a pool
// of eight, else what most steps need.
#include "mesh_path_tables.glsl"
#include "mesh_cast.glsl"
#include "god_object_planes.glsl"
#include "god_object_touch.glsl"
#include "god_object_pool.glsl"
#include "god_object_way.glsl"
#ifdef FS_RARE
#include "mesh_near.glsl"
#include "god_object_entry.glsl"
#endif
#include "god_object_walk.glsl"
#include "god_object_update.glsl"
#include "god_object_rest.glsl"
