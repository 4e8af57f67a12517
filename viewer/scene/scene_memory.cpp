#include "viewer/scene/scene_memory.h"
#include "common/services/error.h"
#include "common/services/memory.h"
#include "common/services/parallel.h"
#include "reflection/picture_memory.h"
#include "viewer/scene/values.h"

namespace kokage {

double estimated_tree_bytes(double leaves) {
    return 2000 * leaves;
}

double estimated_geometry_bytes(double vertices, double triangles) {
    // Positions, normals and texture coordinates in the tree, in the patches and once more on the way; triangles with
    // their patch likewise, and in Embree's tree.
    return 100 * vertices + 200 * triangles;
}

double estimated_transport_bytes(double patches, double error) {
    const double finer = 0.05 / error;
    return patches * (2000 + 5000 * finer * finer);
}

double estimated_picture_bytes(const PictureOptions& options) {
    const double pixels = double(options.width) * double(options.height);
    const double shown = 12 + 8; // tone-mapped, and as it goes into a file; what the drawing took may not be free again
    return picture_bytes(options, thread_count()) + pixels * shown;
}

double estimated_picture_bytes(const PictureOptions& options, const PatchScene& scene) {
    return estimated_picture_bytes(options) + light_bytes(options, scene, thread_count());
}

void check_memory(double bytes, const std::string& what, const std::string& mend) {
    const double available = double(available_memory_bytes());
    if (bytes > available)
        throw InputError(what + " needs about " + bytes_text(bytes) + " of memory, and " + bytes_text(available) +
                         " can be had: " + mend);
}

} // namespace kokage
