#include "foliage/divided_leaves.h"

#include "trees/patches.h"

#include <string>
#include <vector>

namespace kokage {
namespace {

class DividedTransport : public Transport {
  public:
    DividedTransport(const PatchScene& scene, const Tree& tree, int subdivisions, const TransportMaker& make)
        : whole_(scene) {
        PatchOptions options;
        options.leaf_subdivisions = subdivisions;
        options.ground = scene.ground;
        divided_ = make_patches(tree, options);
        divided_.optics = scene.optics;
        std::vector<std::uint32_t> patch_of_leaf(scene.leaf_count, 0);
        std::uint32_t leaves = 0;
        for (std::uint32_t p = 0; p < scene.patches.size(); ++p)
            if (scene.patches[p].kind == PatchKind::leaf) {
                patch_of_leaf[scene.patches[p].leaf] = p;
                ++leaves;
            }
        const std::vector<double> areas = solid_areas(divided_);
        std::vector<double> total(scene.patches.size(), 0.0);
        std::uint32_t bark = leaves;
        for (std::size_t p = 0; p < divided_.patches.size(); ++p) {
            whole_patch_.push_back(divided_.patches[p].kind == PatchKind::leaf ? patch_of_leaf[divided_.patches[p].leaf]
                                                                               : bark++);
            total[whole_patch_.back()] += areas[p];
        }
        std::vector<std::uint32_t> parts(scene.patches.size(), 0);
        for (std::uint32_t whole : whole_patch_)
            ++parts[whole];
        for (std::size_t p = 0; p < divided_.patches.size(); ++p) { // a leaf without area: its parts count alike
            const double area = total[whole_patch_[p]];
            weight_.push_back(float(area > 0 ? areas[p] / area : 1.0 / parts[whole_patch_[p]]));
        }
        transport_ = make(divided_);
    }

    Solution solve(const Environment& environment, Progress& progress) override {
        Solution solution = transport_->solve(environment, progress);
        for (SideRadiance* radiance : {&solution.radiance, &solution.indirect}) {
            average(radiance->front);
            average(radiance->back);
        }
        average(solution.sky_visibility_front);
        average(solution.sky_visibility_back);
        average(solution.bent_normal);
        for (glm::vec3& normal : solution.bent_normal)
            if (const float length = glm::length(normal); length > 0)
                normal /= length;
        solution.report.counts.push_back({"patches after division", divided_.patches.size()});
        solution.report.warnings.push_back(
            "leaves were divided into parts: one radiance a side can't reach the asked error");
        return solution;
    }
    void set_optics(const std::vector<Optics>& optics) override { transport_->set_optics(optics); }
    std::size_t bytes() const override {
        return transport_->bytes() + whole_patch_.size() * sizeof(std::uint32_t) + weight_.size() * sizeof(float);
    }

  private:
    template <class Value>
    void average(std::vector<Value>& values) const {
        if (values.empty())
            return;
        std::vector<Value> means(whole_.patches.size(), Value(0));
        for (std::size_t p = 0; p < values.size(); ++p)
            means[whole_patch_[p]] += weight_[p] * values[p];
        values = std::move(means);
    }

    const PatchScene& whole_;
    PatchScene divided_;
    std::vector<std::uint32_t> whole_patch_; ///< of each part
    std::vector<float> weight_;              ///< of each part in its leaf
    std::unique_ptr<Transport> transport_;
};

} // namespace

bool can_divide_leaves(const PatchScene& scene, const Tree& tree) {
    if (scene.leaf_count == 0 || tree.leaves.size() != scene.leaf_count)
        return false;
    std::size_t triangles = 0;
    for (const TreePart& part : tree.parts)
        triangles += part.triangles.size();
    return triangles == scene.triangles.size() &&
           scene.patches.size() == scene.leaf_count + std::size_t(tree.bark_patch_count);
}

std::unique_ptr<Transport> make_divided_transport(const PatchScene& scene, const Tree& tree, int subdivisions,
                                                  const TransportMaker& make) {
    return std::make_unique<DividedTransport>(scene, tree, subdivisions, make);
}

} // namespace kokage
