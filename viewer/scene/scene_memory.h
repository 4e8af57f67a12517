#pragma once
// How much memory a scene needs, before it is taken.
#include "common/scene/patch_scene.h"
#include "viewer/scene/scene_description.h"

namespace kokage {

/// Bytes that a scene's trees will take when they are grown and placed: measured on species, of every leaf with its
/// share of the wood.
double estimated_tree_bytes(double leaves);
/// Bytes of a tree in memory, again as patches, and with what rays need.
double estimated_geometry_bytes(double vertices, double triangles);
/// Bytes that the `bundles` transport of so many patches takes while it is solved to an error: measured, growing as the
/// links do with error^-2.
double estimated_transport_bytes(double patches, double error);
/// Bytes of a picture with its layers while it is drawn and written, by as many threads as may be used.
double estimated_picture_bytes(const PictureOptions& options);
/// The same of render_picture and a scene that is known.
double estimated_picture_bytes(const PictureOptions& options, const PatchScene& scene);

/// Throws InputError if `bytes` for `what` are not to be had; `mend` says what to reduce. Does nothing where the system
/// doesn't tell.
void check_memory(double bytes, const std::string& what, const std::string& mend);

} // namespace kokage
