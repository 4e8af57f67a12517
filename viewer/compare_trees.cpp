#include "viewer/compare_trees.h"
#include "common/environment/analytic_sky.h"
#include "common/scene/image_file.h"
#include "common/services/count_text.h"
#include "common/services/error.h"
#include "reflection/compare_images.h"
#include "reflection/picture.h"
#include "trees/patches.h"
#include "trees/read_tree.h"
#include "trees/write_tree.h"

#include <algorithm>
#include <cmath>

namespace kokage {
namespace {

struct ShadedFile {
    Tree tree;
    PatchScene scene;
    std::vector<glm::vec3> sides; ///< radiance of leaf sides, as leaf_side_radiance() gives them
};

ShadedFile read(const std::filesystem::path& path, Progress& progress) {
    ShadedFile file;
    const ShadedAttributes shaded = read_shaded(path, progress); // first: says it best if the file is not shaded
    file.tree = read_tree(path, {}, progress);
    file.scene = make_patches(file.tree);
    file.sides = leaf_side_radiance(file.scene, {shaded.radiance_front, shaded.radiance_back});
    return file;
}

/// Throws InputError unless both have the same leaves in the same places.
void check_same_tree(const ShadedFile& a, const ShadedFile& b, const std::string& names) {
    if (a.tree.leaves.size() != b.tree.leaves.size())
        throw InputError(names + " are not the same tree: " + counted(a.tree.leaves.size(), "leaf", "leaves") +
                         " against " + count_text(b.tree.leaves.size()));
    const double tolerance = 1e-4 * double(bounds_of(b.scene).diagonal());
    for (std::size_t i = 0; i < a.tree.leaves.size(); ++i)
        if (glm::length(glm::dvec3(a.tree.leaves[i].centre) + a.tree.origin - glm::dvec3(b.tree.leaves[i].centre) -
                        b.tree.origin) > tolerance)
            throw InputError(names + " are not the same tree: leaf " + std::to_string(i) + " stands elsewhere");
}

/// Relative error of every leaf side: the mean over channels of |x - ref| / max(ref, 0.05 mean ref).
std::vector<double> side_errors(const std::vector<glm::vec3>& sides, const std::vector<glm::vec3>& reference) {
    glm::dvec3 mean(0);
    for (const glm::vec3& side : reference)
        mean += glm::dvec3(side) / double(reference.size());
    std::vector<double> errors(sides.size(), 0.0);
    for (std::size_t s = 0; s < sides.size(); ++s)
        for (std::size_t c = 0; c < 3; ++c) {
            const double off = std::abs(double(sides[s][c]) - double(reference[s][c]));
            const double scale = std::max(double(reference[s][c]), 0.05 * mean[c]);
            errors[s] += (scale > 0 ? off / scale : (off > 0 ? 1.0 : 0.0)) / 3;
        }
    return errors;
}

/// The error colours of reflection, as linear light.
class ErrorColors {
  public:
    glm::vec3 operator()(double share) const {
        const int x = int(std::lround(std::clamp(share, 0.0, 1.0) * (legend_.width - 1)));
        const float* color = legend_.at(x, 0);
        return {linear_from_srgb(color[0]), linear_from_srgb(color[1]), linear_from_srgb(color[2])};
    }

  private:
    Image legend_ = error_legend(256, 1);
};

Image draw(const ShadedFile& reference, const std::vector<double>& errors, double scale, Progress& progress) {
    ShadedScene shaded;
    shaded.patches = &reference.scene;
    const ErrorColors colors;
    for (const Patch& patch : reference.scene.patches) {
        const bool leaf = patch.kind == PatchKind::leaf;
        shaded.radiance_front.push_back(leaf ? colors(errors[2 * patch.leaf] / scale) : glm::vec3(0.1f));
        shaded.radiance_back.push_back(leaf ? colors(errors[2 * patch.leaf + 1] / scale) : glm::vec3(0.1f));
    }
    shaded.indirect_front = shaded.radiance_front;
    shaded.indirect_back = shaded.radiance_back;
    PictureOptions options;
    options.pixel_shadows = false;
    options.gather_rays = 0;
    options.ground = PictureGround::none;
    const RayQueries queries(reference.scene);
    const Camera camera = frame_scene(bounds_of(reference.scene), float(options.width) / float(options.height));
    Image picture =
        render_picture(shaded, queries, constant_environment(glm::vec3(0.f)), camera, options, progress).radiance;
    for (float& value : picture.pixels)
        value = srgb_from_linear(value);
    return picture;
}

} // namespace

TreeComparison compare_trees(const std::filesystem::path& shaded_path, const std::filesystem::path& reference_path,
                             bool draw_map, Progress& progress) {
    const ShadedFile shaded = read(shaded_path, progress), reference = read(reference_path, progress);
    check_same_tree(shaded, reference, "'" + shaded_path.string() + "' and '" + reference_path.string() + "'");
    TreeComparison result;
    result.leaves = reference.tree.leaves.size();
    std::vector<double> leaf_areas(result.leaves, 0.0);
    const std::vector<double> areas = solid_areas(reference.scene);
    for (std::size_t p = 0; p < areas.size(); ++p)
        if (reference.scene.patches[p].kind == PatchKind::leaf)
            leaf_areas[reference.scene.patches[p].leaf] += areas[p];
    result.accuracy = accuracy(shaded.sides, reference.sides, leaf_areas);

    const std::vector<double> errors = side_errors(shaded.sides, reference.sides);
    if (const auto largest = std::max_element(errors.begin(), errors.end()); largest != errors.end()) {
        result.largest = *largest;
        result.largest_leaf = std::size_t(largest - errors.begin()) / 2;
    }
    if (draw_map) {
        result.map_scale = result.accuracy.p95 > 0 ? result.accuracy.p95 : 1;
        result.map = draw(reference, errors, result.map_scale, progress);
    }
    return result;
}

} // namespace kokage
