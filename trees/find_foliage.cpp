#include "trees/find_foliage.h"

#include "common/services/count_text.h"
#include "common/services/error.h"
#include "common/services/named_file.h"
#include "trees/foliage_shape.h"
#include "trees/green_parts.h"
#include "trees/part_names.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>

namespace kokage {
namespace {

std::string display_name(const SceneMaterial& material, int index) {
    return material.name.empty() ? "material " + std::to_string(index) : "'" + shown_name(material.name) + "'";
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

/// The verdict on one mesh, with the rule that gave it; empty rule = undecided.
struct Verdict {
    TreePartKind kind = TreePartKind::bark;
    std::string rule;
    bool mixed_name = false; ///< bark by a name that speaks of leaves too
    bool decided() const { return !rule.empty(); }
};

Verdict judge_name(const NameSense& sense, const std::string& whose) {
    if (!sense.kind)
        return {};
    return {*sense.kind, whose + (sense.is_mixed() ? ", of leaves and of wood, whose last word counts" : ""),
            sense.is_mixed() && *sense.kind == TreePartKind::bark};
}

Verdict judge_material(const SceneMaterial& material) {
    const NameSense sense = sense_of_name(material.name);
    const bool only_wood = sense.wood && !sense.foliage;
    if (material.alpha_mode != AlphaMode::opaque && !only_wood)
        return {TreePartKind::foliage, material.alpha_mode == AlphaMode::mask ? "alpha mask" : "alpha blend"};
    if ((material.diffuse_transmission.value_or(0.f) > 0 || material.transmission > 0) && !only_wood)
        return {TreePartKind::foliage, "it transmits light"};
    return judge_name(sense, "its name");
}

/// Finds foliage rule by rule; a rule judges what those before it left open.
class FoliageFinder {
  public:
    explicit FoliageFinder(MeshScene& scene) : scene_(scene) {}

    FoundFoliage run() {
        for (const SceneMesh& mesh : scene_.meshes)
            verdicts_.push_back(judge_material(scene_.materials[std::size_t(mesh.material)]));
        judge_by_mesh_names();
        judge_by_color();
        if (!any(TreePartKind::foliage))
            judge_by_mixed_names();
        if (!any(TreePartKind::foliage))
            judge_by_shape();
        FoundFoliage found;
        for (const Verdict& verdict : verdicts_)
            found.kinds.push_back(verdict.kind);
        found.notes = notes();
        return found;
    }

  private:
    MeshScene& scene_;
    std::vector<Verdict> verdicts_; ///< of each mesh

    bool any(TreePartKind kind) const {
        return std::any_of(verdicts_.begin(), verdicts_.end(),
                           [&](const Verdict& verdict) { return verdict.decided() && verdict.kind == kind; });
    }

    /// What the node is called, else what the mesh is called.
    Verdict verdict_of_names(const SceneMesh& mesh) const {
        const Verdict by_node = judge_name(sense_of_name(mesh.name), "the name of its mesh");
        return by_node.decided() ? by_node : judge_name(sense_of_name(mesh.mesh_name), "the name of its mesh");
    }

    /// Meshes that node and mesh name alike: how many of their materials could be meant by such a name.
    struct NameGroup {
        std::set<int> undecided, foliage, bark; ///< materials, by their own verdict
        std::array<std::size_t, 2> known{};     ///< meshes of each kind, by material or name
    };
    using Names = std::pair<std::string, std::string>;
    static Names names_of(const SceneMesh& mesh) { return {mesh.name, mesh.mesh_name}; }

    /// Mesh by mesh. One name for surfaces of several materials does not say which of them it means, unless the others
    /// are known to be of the other kind, or the other kind goes by another name.
    void judge_by_mesh_names() {
        const std::size_t count = scene_.meshes.size();
        std::vector<Verdict> by_name;
        std::map<Names, NameGroup> groups;
        std::array<std::size_t, 2> known{};
        for (std::size_t m = 0; m < count; ++m) {
            const SceneMesh& mesh = scene_.meshes[m];
            by_name.push_back(verdict_of_names(mesh));
            NameGroup& group = groups[names_of(mesh)];
            const Verdict& own = verdicts_[m];
            (!own.decided()                      ? group.undecided
             : own.kind == TreePartKind::foliage ? group.foliage
                                                 : group.bark)
                .insert(mesh.material);
            const Verdict& verdict = own.decided() ? own : by_name[m];
            if (verdict.decided()) {
                ++group.known[std::size_t(verdict.kind)];
                ++known[std::size_t(verdict.kind)];
            }
        }
        std::set<int> foliage_materials;
        for (std::size_t m = 0; m < count; ++m) {
            const SceneMesh& mesh = scene_.meshes[m];
            if (!verdicts_[m].decided() && by_name[m].decided()) {
                const TreePartKind kind = by_name[m].kind;
                const NameGroup& group = groups.at(names_of(mesh));
                const bool alone =
                    group.undecided.size() == 1 && (kind == TreePartKind::foliage ? group.foliage : group.bark).empty();
                const auto other =
                    std::size_t(kind == TreePartKind::foliage ? TreePartKind::bark : TreePartKind::foliage);
                if (alone || known[other] > group.known[other])
                    verdicts_[m] = by_name[m];
            }
            if (verdicts_[m].decided() && verdicts_[m].kind == TreePartKind::foliage)
                foliage_materials.insert(mesh.material);
        }
        for (std::size_t m = 0; m < count; ++m) {
            const SceneMesh& mesh = scene_.meshes[m];
            if (!verdicts_[m].decided() && !by_name[m].decided() && foliage_materials.contains(mesh.material) &&
                (names_tree(mesh.name) || names_tree(mesh.mesh_name)))
                verdicts_[m] = {TreePartKind::bark, "the name of its mesh, a tree beside leaves"};
        }
    }

    /// `taken`, triangles of a mesh, become a mesh of foliage; the rest stays, as bark.
    void cut(std::size_t m, const std::vector<bool>& taken, const std::string& rule, const std::string& rest) {
        SceneMesh foliage = take_triangles(scene_.meshes[m], taken);
        scene_.meshes.push_back(std::move(foliage));
        verdicts_[m] = {TreePartKind::bark, rest};
        verdicts_.push_back({TreePartKind::foliage, rule});
    }

    /// Green meshes are foliage, others bark. A mesh that is both is cut in two, unless foliage was found in some
    /// better way.
    void judge_by_color() {
        const bool decided = any(TreePartKind::foliage);
        for (std::size_t m = 0, count = scene_.meshes.size(); m < count; ++m) {
            if (verdicts_[m].decided())
                continue;
            const SceneMesh& mesh = scene_.meshes[m];
            const std::vector<bool> green = green_triangles(mesh, scene_.materials[std::size_t(mesh.material)]);
            const double share = green_share(mesh, green);
            if (!decided && share > 0.05 && share < 0.95)
                cut(m, green, "where it is green", "where it is not green");
            else if (share > 0.5)
                verdicts_[m] = {TreePartKind::foliage, "its green colour"};
            else
                verdicts_[m] = {TreePartKind::bark, decided ? "nothing speaks of leaves" : "its colour is not green"};
        }
    }

    /// "leaf_branch" is taken for wood by its last word; where nothing else is foliage, by its other word.
    void judge_by_mixed_names() {
        for (Verdict& verdict : verdicts_)
            if (verdict.mixed_name)
                verdict = {TreePartKind::foliage, "its name speaks of leaves too, and nothing else does"};
    }

    /// At last: what falls into many small flat pieces is leaves, beside wood or alone.
    void judge_by_shape() {
        constexpr std::size_t kManyPieces = 50;
        constexpr double kSmall = 0.2, kAll = 0.95, kSome = 0.05; // of the scene's diagonal; of the mesh's area
        const double longest = kSmall * diagonal_of(scene_);
        std::vector<LoosePieces> pieces(scene_.meshes.size());
        std::size_t count = 0;
        for (std::size_t m = 0; m < pieces.size(); ++m) {
            const SceneMesh& mesh = scene_.meshes[m];
            const std::string& material = scene_.materials[std::size_t(mesh.material)].name;
            const bool open = !names_wood(material) && !names_object(material) && !names_wood(mesh.name) &&
                              !names_wood(mesh.mesh_name);
            if (open)
                pieces[m] = small_flat_pieces(mesh, longest);
            count += pieces[m].count;
        }
        if (count < kManyPieces)
            return;
        for (std::size_t m = 0; m < pieces.size(); ++m) {
            const std::string rule =
                "found by its shape: " + counted(pieces[m].count, "small flat piece", "small flat pieces");
            if (pieces[m].share >= kAll)
                verdicts_[m] = {TreePartKind::foliage, rule};
            else if (pieces[m].share > kSome && pieces[m].count >= kManyPieces)
                cut(m, pieces[m].triangles, rule, "found by its shape: no small flat pieces");
        }
    }

    /// One for each material, or for each of its rules where its meshes were judged by several.
    std::vector<std::string> notes() const {
        std::map<int, std::map<std::pair<std::string, TreePartKind>, std::vector<std::size_t>>> by_material;
        for (std::size_t m = 0; m < verdicts_.size(); ++m)
            by_material[scene_.meshes[m].material][{verdicts_[m].rule, verdicts_[m].kind}].push_back(m);
        std::vector<std::string> lines;
        for (const auto& [material, rules] : by_material)
            for (const auto& [rule, meshes] : rules)
                lines.push_back("material " + display_name(scene_.materials[std::size_t(material)], material) + " is " +
                                (rule.second == TreePartKind::foliage ? "foliage" : "bark") +
                                (rules.size() > 1 ? mesh_list(meshes) : "") + ": " + rule.first);
        return lines;
    }

    /// " in mesh 'leaves'"; a few of many.
    std::string mesh_list(const std::vector<std::size_t>& meshes) const {
        constexpr std::size_t kShown = 3;
        std::string text = meshes.size() == 1 ? " in mesh " : " in meshes ";
        for (std::size_t i = 0; i < std::min(meshes.size(), kShown); ++i) {
            const SceneMesh& mesh = scene_.meshes[meshes[i]];
            text += (i > 0 ? ", " : "") +
                    (mesh.name.empty() ? std::to_string(mesh.mesh_index) : "'" + shown_name(mesh.name) + "'");
        }
        return text + (meshes.size() > kShown ? " and " + std::to_string(meshes.size() - kShown) + " more" : "");
    }
};

} // namespace

FoundFoliage find_foliage(MeshScene& scene, const std::vector<std::string>& named, const std::string& path) {
    return named.empty() ? FoliageFinder(scene).run() : judge_by_user(scene, named, path);
}

} // namespace kokage
