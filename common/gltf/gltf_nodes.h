#pragma once
// Which meshes stand where in a glTF file's scene. Private to common/gltf.
#include "common/gltf/gltf_document.h"

namespace kokage {

/// A node that carries a mesh.
struct GltfPlacement {
    int mesh = 0;
    int node = 0;
    std::vector<glm::dmat4> transforms; ///< to the world: one, or one an instance (EXT_mesh_gpu_instancing)
};

/// All nodes of a file with their transforms to the world, walked without recursion, so that a deep chain can't exhaust
/// the stack. Nodes form trees, or InputError is thrown.
class GltfNodes {
  public:
    explicit GltfNodes(const GltfDocument& document);

    /// Where meshes stand in the scene that is read: the default one; if it is empty, the first that is not; without
    /// any, all root nodes. Of several levels of detail side by side ("Oak_LOD0", "Oak_LOD1") the finest is kept.
    /// `notes` says what was left out.
    std::vector<GltfPlacement> placements(std::vector<std::string>& notes) const;

    const glm::dmat4& world(int node) const { return world_[std::size_t(node)]; }

  private:
    void order_nodes();
    void check_node(int index, const std::string& place) const;
    bool has_mesh(std::size_t scene) const;
    std::vector<int> all_roots() const;
    std::vector<int> roots(std::vector<std::string>& notes) const;
    std::vector<bool> coarser_levels(const std::vector<bool>& drawn, std::vector<std::string>& notes) const;

    const GltfDocument& document_;
    std::vector<int> parent_;
    std::vector<int> order_; ///< parents before children
    std::vector<glm::dmat4> world_;
};

} // namespace kokage
