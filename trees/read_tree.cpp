#include "trees/read_tree.h"

#include "common/services/error.h"
#include "trees/find_branching.h"
#include "trees/find_foliage.h"
#include "trees/foreign_tree.h"

#include <cmath>

namespace kokage {

Tree read_tree(const std::filesystem::path& path, const ReadOptions& options, Progress& progress) {
    if (!(options.scale > 0) || !std::isfinite(options.scale))
        throw InputError("the scale of a tree is " + std::to_string(options.scale) + "; it must be above 0");
    if (!(options.leaf_size >= 0) || !std::isfinite(options.leaf_size))
        throw InputError("the leaf size is " + std::to_string(options.leaf_size) +
                         " m; it must be 0 (found by itself) or above");
    const GltfDocument document = GltfDocument::read(path, progress);
    return read_foreign_tree(document, options, progress);
}

} // namespace kokage
