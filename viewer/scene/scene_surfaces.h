#pragma once
// What trees and objects of a scene wear: their own materials changed by the scene's, each once; and how they look.
#include "common/services/work_report.h"
#include "trees/merge_trees.h"
#include "trees/patches.h"
#include "viewer/scene/material_relief.h"
#include "viewer/scene/scene_materials.h"
#include "viewer/scene/scene_messages.h"

#include <set>
#include <tuple>

namespace kokage {

/// A tree or object with the names of the materials that it wears.
struct Wearer {
    const Tree* tree = nullptr;
    const std::vector<Finish>* finishes = nullptr; ///< objects: of each of its materials
    double size = 1;                               ///< how many times as large it stands there as it was made
    std::string leaf_material, bark_material;      ///< empty: its own
    std::string pointer;                           ///< where it stands in the scene file
    float foot = 0, top = 0;                       ///< its least and greatest height there
};

class SceneSurfaces {
  public:
    /// Both must outlive it.
    SceneSurfaces(const SceneDescription& description, const SceneMessages& messages)
        : description_(description), messages_(messages) {}

    /// The numbers of its materials in `all`, to which new ones are added. The same tree or object in the same clothes
    /// shares them, unless they depend on where it stands. Throws InputError.
    const MaterialNumbers& dress(const Wearer& wearer, Tree& all);

    /// Looks of the parts of the tree that was made of all wearers, with gloss and relief. What is doubtful goes to the
    /// report. Throws InputError.
    std::vector<SurfaceLook> looks(const Tree& tree, WorkReport& report);

    /// What mirrors does not scatter twice. After looks().
    void take_gloss_off(const Tree& tree, const PatchOrigins& origins, PatchScene& patches) const;

    /// Loads the textures of materials that nothing wears, which is of no use but to measure. After all dress(). Throws
    /// InputError.
    void load_unworn();

    /// Tells the materials that nothing wears.
    void report_skips(WorkReport& report) const;

  private:
    const MaterialDescription* material_named(const std::string& name, const std::string& pointer);
    std::uint32_t add_surface(const Wearer& wearer, std::size_t material, const std::string& name, Tree& all);
    std::vector<std::string> unworn() const; ///< names of materials
    LookRelief relief_of(const SceneSurface& surface, TreePartKind kind, MaterialReliefs& heights, WorkReport& report);
    void warn_of_idle_reliefs(const Tree& tree, const std::vector<SurfaceLook>& looks, WorkReport& report) const;

    const SceneDescription& description_;
    const SceneMessages& messages_;
    std::map<std::tuple<const Tree*, std::string, std::string, float, float, float>, MaterialNumbers> dressed_;
    std::vector<SceneSurface> surfaces_; ///< of each of the tree's materials
    std::vector<std::pair<float, float>> heights_;
    std::vector<Gloss> glosses_;
    std::set<std::string> used_materials_;
    TextureFiles textures_;
};

} // namespace kokage
