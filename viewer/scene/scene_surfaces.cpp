#include "viewer/scene/scene_surfaces.h"
#include "common/services/count_text.h"
#include "common/services/named_file.h"
#include "viewer/scene/shaded_scene.h"

namespace kokage {
namespace {

constexpr std::uint32_t kNone = ~0u;

/// Materials are not shared between foliage and bark here.
TreePartKind kind_of(const Tree& tree, std::uint32_t material) {
    for (const TreePart& part : tree.parts)
        if (part.material == material)
            return part.kind;
    return TreePartKind::bark;
}

} // namespace

const MaterialDescription* SceneSurfaces::material_named(const std::string& name, const std::string& pointer) {
    if (name.empty())
        return nullptr;
    const auto found = description_.materials.find(name);
    if (found == description_.materials.end())
        messages_.fail(pointer, "there is no material '" + shown_name(name) + "'");
    used_materials_.insert(name);
    return &found->second;
}

std::uint32_t SceneSurfaces::add_surface(const Wearer& wearer, std::size_t material, const std::string& name,
                                         Tree& all) {
    SceneSurface surface{wearer.tree->materials[material], {}};
    if (wearer.finishes)
        surface.finish = (*wearer.finishes)[material];
    surface.material.height_depth_m *= float(wearer.size); // metres on the tree as it was made
    surface.material.height_tile_m *= float(wearer.size);
    if (const MaterialDescription* description = material_named(name, wearer.pointer))
        surface = messages_.told_at(description->pointer,
                                    [&] { return changed_surface(std::move(surface), *description, textures_); });
    all.materials.push_back(surface.material);
    surfaces_.push_back(std::move(surface));
    heights_.emplace_back(wearer.foot, wearer.top);
    return std::uint32_t(all.materials.size() - 1);
}

const MaterialNumbers& SceneSurfaces::dress(const Wearer& wearer, Tree& all) {
    const auto by_height = [&](const std::string& name) {
        const MaterialDescription* material = material_named(name, wearer.pointer);
        return material && material->roughness_from_foot_to_top;
    };
    bool has_heights = false;
    for (const TreeMaterial& material : wearer.tree->materials)
        has_heights |= bool(material.height_texture);
    const bool depends = by_height(wearer.leaf_material) || by_height(wearer.bark_material);
    const auto [entry, is_new] =
        dressed_.try_emplace({wearer.tree, wearer.leaf_material, wearer.bark_material, depends ? wearer.foot : 0.f,
                              depends ? wearer.top : 0.f, has_heights ? float(wearer.size) : 1.f});
    MaterialNumbers& result = entry->second;
    if (!is_new)
        return result;
    const std::size_t count = wearer.tree->materials.size();
    result.bark.assign(count, kNone);
    result.foliage.assign(count, kNone);
    for (const TreePart& part : wearer.tree->parts) {
        const bool is_bark = part.kind == TreePartKind::bark;
        std::uint32_t& number = (is_bark ? result.bark : result.foliage)[part.material];
        if (number == kNone)
            number = add_surface(wearer, part.material, is_bark ? wearer.bark_material : wearer.leaf_material, all);
    }
    return result;
}

std::vector<SurfaceLook> SceneSurfaces::looks(const Tree& tree, WorkReport& report) {
    std::vector<glm::vec3> means;
    std::vector<LookRelief> reliefs;
    MaterialReliefs heights;
    glosses_.clear();
    for (std::uint32_t m = 0; m < surfaces_.size(); ++m) {
        const TreePartKind kind = kind_of(tree, m);
        means.push_back(mean_base_color(tree, m, kind));
        glosses_.push_back(gloss_of(surfaces_[m], means[m], heights_[m].first, heights_[m].second));
        reliefs.push_back(relief_of(surfaces_[m], kind, heights, report));
    }
    std::vector<SurfaceLook> looks;
    for (const TreePart& part : tree.parts) {
        SurfaceLook& look = looks.emplace_back(look_of(tree, part, means[part.material]));
        look.gloss = glosses_[part.material];
        if (part.uvs.empty())
            continue;
        look.relief = reliefs[part.material];
        const std::optional<ReliefDescription>& asked = surfaces_[part.material].finish.relief;
        if (part.kind == TreePartKind::bark && !look.relief.heights && !(asked && asked->none)) {
            look.normal_texture = tree.materials[part.material].normal_texture;
            look.normal_scale = tree.materials[part.material].normal_scale;
        }
    }
    warn_of_idle_reliefs(tree, looks, report);
    return looks;
}

LookRelief SceneSurfaces::relief_of(const SceneSurface& surface, TreePartKind kind, MaterialReliefs& heights,
                                    WorkReport& report) {
    if (kind == TreePartKind::foliage)
        return {};
    const Finish& finish = surface.finish;
    return messages_.told_at(finish.relief ? finish.pointer + "/relief" : "", [&] {
        return finish.relief ? heights.described(*finish.relief, surface.material, report)
                             : heights.own(surface.material);
    });
}

/// A tree's bark has heights of its own where it is thick, and its twigs none: what a material says of relief must be
/// seen somewhere of what wears it.
void SceneSurfaces::warn_of_idle_reliefs(const Tree& tree, const std::vector<SurfaceLook>& looks,
                                         WorkReport& report) const {
    std::map<std::string, std::pair<bool, const char*>> worn;
    for (std::size_t k = 0; k < looks.size(); ++k) {
        const TreePart& part = tree.parts[k];
        const Finish& finish = surfaces_[part.material].finish;
        if (!finish.relief || finish.relief->none)
            continue;
        auto& [shown, why] = worn.try_emplace(finish.pointer + "/relief", false, "").first->second;
        shown |= bool(looks[k].relief.heights);
        why = part.kind == TreePartKind::foliage ? "leaves have no relief"
              : part.uvs.empty()                 ? "what wears it has no texture coordinates"
                                 : "what wears it has no heights of its own; give 'heights' or 'normals'";
    }
    for (const auto& [pointer, state] : worn)
        if (!state.first)
            report.warnings.push_back(messages_.in_file(pointer + ": it changes nothing: " + state.second));
}

void SceneSurfaces::take_gloss_off(const Tree& tree, const PatchOrigins& origins, PatchScene& patches) const {
    std::vector<bool> done(patches.optics.size(), false);
    for (const Patch& patch : patches.patches) {
        if (patch.triangle_count == 0 || done[patch.optics])
            continue;
        done[patch.optics] = true;
        const std::uint32_t material = tree.parts[origins.triangle_part[patch.first_triangle]].material;
        const glm::vec3 share = diffuse_share(surfaces_[material], glosses_[material]);
        patches.optics[patch.optics].reflectance *= share;
        patches.optics[patch.optics].transmittance *= share;
    }
}

std::vector<std::string> SceneSurfaces::unworn() const {
    std::vector<std::string> names;
    for (const auto& [name, material] : description_.materials)
        if (!used_materials_.contains(name))
            names.push_back(name);
    return names;
}

void SceneSurfaces::load_unworn() {
    for (const std::string& name : unworn()) {
        const MaterialDescription& material = description_.materials.at(name);
        messages_.told_at(material.pointer, [&] { return changed_surface({}, material, textures_); });
    }
}

void SceneSurfaces::report_skips(WorkReport& report) const {
    const std::vector<std::string> names = unworn();
    std::string listed;
    for (const std::string& name : names)
        listed += (listed.empty() ? "'" : ", '") + shown_name(name) + "'";
    if (!names.empty())
        report.skips.push_back(
            {counted(names.size(), "material", "materials"), "nothing wears " + listed, "loading their textures"});
}

} // namespace kokage
