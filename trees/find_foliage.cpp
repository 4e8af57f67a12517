#include "trees/find_foliage.h"

#include "common/services/error.h"
#include "trees/green_parts.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <map>

namespace kokage {
namespace {

std::string lower_case(const std::string& text) {
    std::string result = text;
    std::transform(result.begin(), result.end(), result.begin(), [](unsigned char c) { return char(std::tolower(c)); });
    return result;
}

template <std::size_t N>
bool holds_any(const std::string& name, const std::array<const char*, N>& words) {
    const std::string lower = lower_case(name);
    return std::any_of(words.begin(), words.end(),
                       [&](const char* word) { return lower.find(word) != std::string::npos; });
}

constexpr std::array kFoliageWords = {"leaf",  "leav",   "foliage", "needle", "blossom", "petal", "flower", "frond",
                                      "crown", "canopy", "folha",   "blatt",  "feuille", "grass", "fern"};
constexpr std::array kWoodWords = {"bark", "wood", "trunk", "branch", "stem", "twig", "root", "log", "stump", "brown"};
constexpr std::array kObjectWords = {"pot", "vase", "soil", "dirt", "stone", "rock", "pebble", "ground", "planter"};
constexpr std::array kColorWords = {"green", "autumn", "fall"};

std::string display_name(const SceneMaterial& material, int index) {
    return material.name.empty() ? "material " + std::to_string(index) : "'" + material.name + "'";
}

FoundFoliage judge_by_user(const MeshScene& scene, const std::vector<std::string>& named, const std::string& path) {
    FoundFoliage found;
    found.kinds.assign(scene.meshes.size(), TreePartKind::bark);
    for (const std::string& name : named) {
        const std::string wanted = lower_case(name);
        bool fits = false;
        for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
            const SceneMesh& mesh = scene.meshes[m];
            if (lower_case(scene.materials[std::size_t(mesh.material)].name) == wanted ||
                lower_case(mesh.name) == wanted || lower_case(mesh.mesh_name) == wanted) {
                found.kinds[m] = TreePartKind::foliage;
                fits = true;
            }
        }
        if (!fits) {
            std::string names;
            for (std::size_t m = 0; m + 1 < scene.materials.size() && m < 20; ++m)
                names += (names.empty() ? "" : ", ") + display_name(scene.materials[m], int(m));
            throw InputError(path + ": no material or mesh is named '" + name + "'; its materials are " +
                             (names.empty() ? "none" : names));
        }
    }
    found.notes.push_back("foliage: as named by the user");
    return found;
}

/// The verdict on one material, with the rule that gave it; empty rule = undecided.
struct Verdict {
    TreePartKind kind = TreePartKind::bark;
    std::string rule;
};

Verdict judge_material(const SceneMaterial& material) {
    const bool wood = names_wood(material.name) && !names_foliage(material.name);
    if (material.alpha_mode != AlphaMode::opaque && !wood)
        return {TreePartKind::foliage, material.alpha_mode == AlphaMode::mask ? "alpha mask" : "alpha blend"};
    if ((material.diffuse_transmission.value_or(0.f) > 0 || material.transmission > 0) && !wood)
        return {TreePartKind::foliage, "it transmits light"};
    if (names_foliage(material.name))
        return {TreePartKind::foliage, "its name"};
    if (wood)
        return {TreePartKind::bark, "its name"};
    return {};
}

/// The last resort, mesh by mesh: green meshes are foliage, others bark. A mesh that is both is cut in two, unless
/// foliage was found in some better way.
Verdict judge_by_color(MeshScene& scene, const std::vector<std::size_t>& meshes, int material, bool decided,
                       std::vector<TreePartKind>& kinds) {
    std::size_t foliage = 0, bark = 0, cut = 0;
    for (const std::size_t m : meshes) {
        const std::vector<bool> green = green_triangles(scene.meshes[m], scene.materials[std::size_t(material)]);
        const double share = green_share(scene.meshes[m], green);
        if (!decided && share > 0.05 && share < 0.95) {
            scene.meshes.push_back(take_green(scene.meshes[m], green));
            kinds.push_back(TreePartKind::foliage);
            kinds[m] = TreePartKind::bark;
            ++cut;
        } else {
            kinds[m] = share > 0.5 ? TreePartKind::foliage : TreePartKind::bark;
            ++(share > 0.5 ? foliage : bark);
        }
    }
    if (cut > 0)
        return {TreePartKind::foliage, "where it is green; the rest is bark"};
    if (foliage > 0)
        return {TreePartKind::foliage, bark > 0 ? "its green meshes; the others are bark" : "its green colour"};
    return {TreePartKind::bark, decided ? "nothing speaks of leaves" : "its colour is not green"};
}

} // namespace

bool names_wood(const std::string& name) {
    return holds_any(name, kWoodWords);
}
bool names_object(const std::string& name) {
    return holds_any(name, kObjectWords) && !names_wood(name) && !names_foliage(name);
}
bool names_foliage(const std::string& name) {
    return holds_any(name, kFoliageWords) || (holds_any(name, kColorWords) && !names_wood(name));
}

FoundFoliage find_foliage(MeshScene& scene, const std::vector<std::string>& named, const std::string& path) {
    if (!named.empty())
        return judge_by_user(scene, named, path);
    FoundFoliage found;
    std::map<int, Verdict> verdicts;
    std::map<int, std::vector<std::size_t>> meshes_of; // by material
    for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
        const int material = scene.meshes[m].material;
        if (verdicts.try_emplace(material).second)
            verdicts[material] = judge_material(scene.materials[std::size_t(material)]);
        meshes_of[material].push_back(m);
    }
    const auto any_foliage = [&] {
        return std::any_of(verdicts.begin(), verdicts.end(), [](const auto& entry) {
            return entry.second.kind == TreePartKind::foliage && !entry.second.rule.empty();
        });
    };
    // Undecided materials: by what the meshes that wear them are called, then, as a last resort, by colour.
    for (auto& [index, verdict] : verdicts) {
        if (!verdict.rule.empty())
            continue;
        bool foliage = false, wood = false;
        for (const std::size_t m : meshes_of.at(index)) {
            const SceneMesh& mesh = scene.meshes[m];
            foliage = foliage || names_foliage(mesh.name) || names_foliage(mesh.mesh_name);
            wood = wood || names_wood(mesh.name) || names_wood(mesh.mesh_name);
        }
        if (foliage != wood)
            verdict = {foliage ? TreePartKind::foliage : TreePartKind::bark, "the name of its mesh"};
    }
    for (const SceneMesh& mesh : scene.meshes)
        found.kinds.push_back(verdicts.at(mesh.material).kind);
    const bool decided = any_foliage();
    for (auto& [index, verdict] : verdicts) {
        if (verdict.rule.empty())
            verdict = judge_by_color(scene, meshes_of.at(index), index, decided, found.kinds);
        found.notes.push_back("material " + display_name(scene.materials[std::size_t(index)], index) + " is " +
                              (verdict.kind == TreePartKind::foliage ? "foliage" : "bark") + ": " + verdict.rule);
    }
    return found;
}

} // namespace kokage
