#include "viewer/scene/assemble_scene.h"
#include "common/services/count_text.h"
#include "common/services/error.h"
#include "common/services/named_file.h"
#include "trees/merge_trees.h"
#include "viewer/scene/material_relief.h"
#include "viewer/scene/object_tree.h"
#include "viewer/scene/scene_materials.h"
#include "viewer/scene/scene_memory.h"
#include "viewer/scene/shaded_scene.h"
#include "viewer/scene/stage_clock.h"

#include <algorithm>
#include <limits>
#include <set>
#include <sstream>
#include <tuple>

namespace kokage {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Box {
    glm::dvec3 low{kInfinity}, high{-kInfinity};
    void add(const glm::dvec3& point) {
        low = glm::min(low, point);
        high = glm::max(high, point);
    }
    bool empty() const { return !(low.x <= high.x); }
};

Box box_of(const Tree& tree) {
    Box box;
    for (const TreePart& part : tree.parts)
        for (const glm::vec3& position : part.positions)
            box.add(glm::dvec3(position));
    return box;
}

/// Where a tree stands: the middle of its stems, at their foot; of what has none, the middle of its box.
glm::dvec3 foot_of(const Tree& tree, const Box& box) {
    glm::dvec3 foot = 0.5 * (box.low + box.high), sum(0.0);
    float thickest = 0;
    double stems = 0;
    for (const Branch& branch : tree.skeleton.branches)
        if (branch.parent < 0)
            thickest = std::max(thickest, branch.nodes.front().radius_m);
    for (const Branch& branch : tree.skeleton.branches)
        if (branch.parent < 0 && branch.nodes.front().radius_m >= 0.5f * thickest) {
            sum += glm::dvec3(branch.nodes.front().position);
            ++stems;
        }
    if (stems > 0)
        foot = sum / stems;
    foot.y = double(foot_height(tree));
    return foot;
}

class SceneAssembly {
  public:
    SceneAssembly(const SceneDescription& description, Progress& progress)
        : description_(description), progress_(progress) {}

    AssembledScene assemble() {
        check_description();
        clock_.run("trees", [&] { load_trees(); });
        clock_.run("objects", [&] { load_objects(); });
        place_all();
        clock_.run("merge", [&] { merge(); });
        progress_.throw_if_stopped();
        clock_.run("environment", [&] { light(); });
        clock_.run("patches", [&] { make_scene(); });
        set_camera();
        report();
        return std::move(scene_);
    }

  private:
    /// Something of the scene with its place.
    struct Thing {
        const Tree* tree = nullptr;
        const std::vector<Finish>* finishes = nullptr; ///< objects
        TreePlacement placement;
        std::string leaf_material, bark_material;
        std::string pointer;
        Box box; ///< placed, in the world
    };
    struct LoadedTree {
        Tree tree;
        Box box;
        glm::dvec3 foot{0.0};
    };

    [[noreturn]] void fail(const std::string& pointer, const std::string& what) const {
        const std::string where = description_.file.empty() ? "" : description_.file.string() + ": ";
        throw InputError(where + (pointer.empty() ? "" : pointer + ": ") + what);
    }

    template <typename Work>
    auto told_at(const std::string& pointer, Work&& work) const {
        try {
            return work();
        } catch (const InputError& error) {
            fail(pointer, error.what());
        }
    }

    void check_placement(const Placement& placement, const std::string& pointer) const {
        const auto all_finite = [](const glm::dvec3& v) { return std::isfinite(glm::dot(v, v)); };
        if (!all_finite(placement.at) || !std::isfinite(placement.turn_degrees))
            fail(pointer, "its place must be finite numbers");
        if (!(placement.size > 0) || !std::isfinite(placement.size))
            fail(pointer + "/size", "it is " + std::to_string(placement.size) + "; it must be above 0");
    }

    double asked_leaves(const PlacedTree& placed) const {
        return placed.source.is_species() ? double(asked_species(source_of(placed)).parameters.leaves) : 0;
    }

    /// Before anything is grown: what will not fit is refused.
    void check_description() const {
        check_surroundings(description_.surroundings);
        double leaves = 0;
        for (const PlacedTree& placed : description_.trees) {
            check_placement(placed.placement, placed.pointer);
            leaves += told_at(placed.pointer, [&] { return asked_leaves(placed); });
        }
        for (const PlacedObject& placed : description_.objects)
            check_placement(placed.placement, placed.pointer);
        if (leaves > double(std::numeric_limits<std::int32_t>::max()))
            fail("", count_text(std::uint64_t(leaves)) + " leaves can't be numbered; take fewer trees or --leaves");
        told_at("", [&] {
            check_memory(estimated_tree_bytes(leaves), "a scene of " + count_text(std::uint64_t(leaves)) + " leaves",
                         "take fewer trees, or fewer leaves a tree");
            check_memory(estimated_picture_bytes(description_.picture),
                         "a picture of " + std::to_string(description_.picture.width) + " x " +
                             std::to_string(description_.picture.height) + " pixels",
                         "make it smaller");
        });
    }

    static TreeSource source_of(const PlacedTree& placed) {
        TreeSource source = placed.source;
        if (placed.seed)
            source.settings.push_back("seed=" + std::to_string(*placed.seed));
        return source;
    }

    static std::string key_of(const TreeSource& source) {
        std::ostringstream key;
        key.precision(17);
        key << source.name << '\n'
            << source.leaves.value_or(-1) << '\n'
            << source.leaf_size << '\n'
            << source.scale << '\n'
            << source.up;
        for (const auto* list : {&source.settings, &source.foliage}) {
            key << "\n-";
            for (const std::string& text : *list)
                key << '\n' << text;
        }
        return key.str();
    }

    void load_trees() {
        for (const PlacedTree& placed : description_.trees) {
            const TreeSource source = source_of(placed);
            const auto [entry, is_new] = trees_.try_emplace(key_of(source));
            LoadedTree& loaded = entry->second;
            if (is_new) {
                loaded.tree = told_at(placed.pointer, [&] {
                    check_tree_source(source);
                    return obtain_tree(source, progress_);
                });
                loaded.box = box_of(loaded.tree);
                loaded.foot = foot_of(loaded.tree, loaded.box);
                take_notes(loaded.tree);
            }
            progress_.throw_if_stopped();
            Thing& thing = things_.emplace_back();
            thing.tree = &loaded.tree;
            thing.placement = {loaded.foot, placed.placement.at, placed.placement.turn_degrees, placed.placement.size};
            thing.leaf_material = placed.leaf_material;
            thing.bark_material = placed.bark_material;
            thing.pointer = placed.pointer;
            set_box(thing, loaded.box);
        }
    }

    void load_objects() {
        for (const PlacedObject& placed : description_.objects) {
            const auto [entry, is_new] = objects_.try_emplace({placed.file, placed.up});
            ObjectTree& object = entry->second;
            if (is_new) {
                object = told_at(placed.pointer, [&] {
                    return object_tree(read_object(placed.file, progress_), placed.file, placed.up == "z");
                });
                take_notes(object.tree);
            }
            progress_.throw_if_stopped();
            Thing& thing = things_.emplace_back();
            thing.tree = &object.tree;
            thing.finishes = &object.finishes;
            const glm::dvec3 middle = 0.5 * (object.low + object.high);
            thing.placement = {{middle.x, object.low.y, middle.z},
                               placed.placement.at,
                               placed.placement.turn_degrees,
                               placed.placement.size * unit_of(placed, object)};
            thing.bark_material = placed.material;
            thing.pointer = placed.pointer;
            set_box(thing, {object.low, object.high});
        }
    }

    /// Metres in a unit of the object's file.
    double unit_of(const PlacedObject& placed, const ObjectTree& object) const {
        if (!placed.height_m)
            return 1;
        const double height = object.high.y - object.low.y;
        if (!(*placed.height_m > 0) || !std::isfinite(*placed.height_m))
            fail(placed.pointer + "/height", "it is " + std::to_string(*placed.height_m) + "; it must be above 0");
        if (!(height > 0))
            fail(placed.pointer + "/height", "'" + placed.file.string() +
                                                 "' is flat: it has no height that could be scaled; give 'size' "
                                                 "instead");
        return *placed.height_m / height;
    }

    void take_notes(const Tree& tree) {
        for (const std::string& note : tree.notes)
            scene_.tree.notes.push_back(shown_name(tree.name) + ": " + note);
    }

    static void set_box(Thing& thing, const Box& own) {
        for (unsigned k = 0; k < 8 && !own.empty(); ++k)
            thing.box.add(placed_point(
                thing.placement,
                {k & 1 ? own.high.x : own.low.x, k & 2 ? own.high.y : own.low.y, k & 4 ? own.high.z : own.low.z},
                glm::dvec3(0.0)));
    }

    void place_all() {
        Box box;
        double lowest = kInfinity, vertices = 0, triangles = 0;
        for (const Thing& thing : things_) {
            lowest = std::min(lowest, thing.placement.at.y);
            if (!thing.box.empty()) {
                box.add(thing.box.low);
                box.add(thing.box.high);
            }
            for (const TreePart& part : thing.tree->parts) {
                vertices += double(part.positions.size());
                triangles += double(part.triangles.size());
            }
        }
        told_at("", [&] {
            check_memory(estimated_geometry_bytes(vertices, triangles),
                         "a scene of " + count_text(std::uint64_t(triangles)) + " triangles",
                         "take fewer trees or objects, or fewer leaves a tree");
        });
        scene_.tree.origin = box.empty() ? glm::dvec3(0.0) : choose_origin(box.low, box.high);
        scene_.foot_height = lowest < kInfinity ? float(lowest - scene_.tree.origin.y) : 0.f;
    }

    const MaterialDescription* material_named(const std::string& name, const std::string& pointer) {
        if (name.empty())
            return nullptr;
        const auto found = description_.materials.find(name);
        if (found == description_.materials.end())
            fail(pointer, "there is no material '" + shown_name(name) + "'");
        used_materials_.insert(name);
        return &found->second;
    }

    std::uint32_t add_surface(const Thing& thing, std::size_t material, const std::string& name, float foot,
                              float top) {
        SceneSurface surface{thing.tree->materials[material], {}};
        if (thing.finishes)
            surface.finish = (*thing.finishes)[material];
        surface.material.height_depth_m *= float(thing.placement.size); // metres on the tree as it was made
        surface.material.height_tile_m *= float(thing.placement.size);
        if (const MaterialDescription* description = material_named(name, thing.pointer))
            surface = told_at(description->pointer,
                              [&] { return changed_surface(std::move(surface), *description, textures_); });
        scene_.tree.materials.push_back(surface.material);
        surfaces_.push_back(std::move(surface));
        heights_.emplace_back(foot, top);
        return std::uint32_t(scene_.tree.materials.size() - 1);
    }

    /// The same tree or object in the same clothes shares its materials, unless they depend on where it stands.
    const MaterialNumbers& dressed(const Thing& thing) {
        const float foot = float(thing.box.low.y - scene_.tree.origin.y),
                    top = float(thing.box.high.y - scene_.tree.origin.y);
        const auto by_height = [&](const std::string& name) {
            const MaterialDescription* material = material_named(name, thing.pointer);
            return material && material->roughness_from_foot_to_top;
        };
        bool has_heights = false;
        for (const TreeMaterial& material : thing.tree->materials)
            has_heights |= bool(material.height_texture);
        const bool depends = by_height(thing.leaf_material) || by_height(thing.bark_material);
        const auto [entry, is_new] =
            dressed_.try_emplace({thing.tree, thing.leaf_material, thing.bark_material, depends ? foot : 0.f,
                                  depends ? top : 0.f, has_heights ? float(thing.placement.size) : 1.f});
        MaterialNumbers& result = entry->second;
        if (!is_new)
            return result;
        const std::size_t count = thing.tree->materials.size();
        result.bark.assign(count, kNone);
        result.foliage.assign(count, kNone);
        for (const TreePart& part : thing.tree->parts) {
            const bool is_bark = part.kind == TreePartKind::bark;
            std::uint32_t& number = (is_bark ? result.bark : result.foliage)[part.material];
            if (number == kNone)
                number =
                    add_surface(thing, part.material, is_bark ? thing.bark_material : thing.leaf_material, foot, top);
        }
        return result;
    }

    void merge() {
        scene_.tree.name = description_.name;
        scene_.tree.source = description_.file.string();
        progress_.begin("placing trees and objects", things_.size());
        for (const Thing& thing : things_) {
            progress_.throw_if_stopped();
            add_tree(scene_.tree, *thing.tree, thing.placement, dressed(thing));
            if (!thing.finishes)
                scene_.tree_parts = scene_.tree.parts.size();
            progress_.advance(1);
        }
        trees_.clear();
        objects_.clear();
        things_.clear();
    }

    void light() {
        EnvironmentReport& report = scene_.environment_report;
        scene_.environment = obtain_environment(description_.surroundings, scene_.tree.origin, report, true,
                                                description_.environment_turn_degrees);
        scene_.report.warnings = report.warnings;
        if (const std::optional<std::string> night = night_warning(description_.surroundings))
            scene_.report.warnings.push_back(*night);
        if (description_.environment_turn_degrees != 0 && !is_environment_image(description_.surroundings))
            scene_.report.warnings.push_back(
                "the environment's turn changes nothing: it is no image (the sky's sun has "
                "an azimuth of its own)");
    }

    void make_scene() {
        PatchOptions options;
        options.ground = obtain_ground(description_.surroundings, scene_.environment, scene_.foot_height);
        if (options.ground)
            for (const std::string& hidden : drop_hidden_lights(scene_.environment, *options.ground))
                scene_.report.warnings.push_back(hidden);
        scene_.environment.description += added_lights_text(description_.surroundings, scene_.environment);
        scene_.patches = make_patches(scene_.tree, options, &scene_.origins);
        scene_.triangle_look = scene_.origins.triangle_part;
        std::vector<Gloss> glosses;
        std::vector<glm::vec3> means;
        std::vector<LookRelief> reliefs;
        MaterialReliefs heights;
        for (std::uint32_t m = 0; m < surfaces_.size(); ++m) {
            means.push_back(mean_base_color(scene_.tree, m, kind_of(m)));
            glosses.push_back(gloss_of(surfaces_[m], means[m], heights_[m].first, heights_[m].second));
            reliefs.push_back(relief_of(surfaces_[m], kind_of(m), heights));
        }
        for (const TreePart& part : scene_.tree.parts) {
            scene_.looks.push_back(look_of(scene_.tree, part, means[part.material]));
            scene_.looks.back().gloss = glosses[part.material];
            if (!part.uvs.empty())
                scene_.looks.back().relief = reliefs[part.material];
        }
        take_gloss_off(glosses);
    }

    LookRelief relief_of(const SceneSurface& surface, TreePartKind kind, MaterialReliefs& heights) {
        if (kind == TreePartKind::foliage)
            return {};
        const Finish& finish = surface.finish;
        // A tree's bark has heights of its own where it is thick, and its twigs none.
        const bool own = !finish.relief || (finish.relief->heights.empty() && finish.relief->normals.empty() &&
                                            !surface.material.height_texture);
        return told_at("", [&] {
            return !own ? heights.described(*finish.relief, surface.material, finish.pointer, scene_.report)
                        : heights.own(surface.material);
        });
    }

    /// Materials are not shared between foliage and bark here.
    TreePartKind kind_of(std::uint32_t material) const {
        for (const TreePart& part : scene_.tree.parts)
            if (part.material == material)
                return part.kind;
        return TreePartKind::bark;
    }

    void take_gloss_off(const std::vector<Gloss>& glosses) {
        std::vector<bool> done(scene_.patches.optics.size(), false);
        for (const Patch& patch : scene_.patches.patches) {
            if (patch.triangle_count == 0 || done[patch.optics])
                continue;
            done[patch.optics] = true;
            const std::uint32_t material =
                scene_.tree.parts[scene_.origins.triangle_part[patch.first_triangle]].material;
            const glm::vec3 share = diffuse_share(surfaces_[material], glosses[material]);
            scene_.patches.optics[patch.optics].reflectance *= share;
            scene_.patches.optics[patch.optics].transmittance *= share;
        }
    }

    void set_camera() {
        const CameraDescription& asked = description_.camera;
        const float aspect = float(description_.picture.width) / float(std::max(description_.picture.height, 1));
        const float angle = float(asked.vertical_field_of_view_degrees * kPiDouble / 180);
        if (asked.position && asked.target) {
            scene_.camera.position = glm::vec3(*asked.position - scene_.tree.origin);
            scene_.camera.target = glm::vec3(*asked.target - scene_.tree.origin);
            scene_.camera.vertical_field_of_view = angle;
            return;
        }
        if (asked.position || asked.target)
            fail("/camera", "it has only one of position and target; give both, or neither");
        const float azimuth = asked.azimuth_degrees ? float(*asked.azimuth_degrees * kPiDouble / 180)
                                                    : photographers_azimuth(scene_.environment);
        scene_.camera = frame_scene(scene_.patches, aspect, azimuth, angle);
    }

    void report() {
        WorkReport& report = scene_.report;
        report.stages = clock_.stages();
        std::size_t unused = 0;
        std::string names;
        for (const auto& [name, material] : description_.materials)
            if (!used_materials_.contains(name)) {
                names += (unused++ == 0 ? "'" : ", '") + shown_name(name) + "'";
            }
        if (unused > 0)
            report.skips.push_back(
                {counted(unused, "material", "materials"), "nothing wears " + names, "their textures were not loaded"});
        report.counts.push_back({"trees", description_.trees.size()});
        report.counts.push_back({"objects", description_.objects.size()});
        report.counts.push_back({"leaves", scene_.tree.leaves.size()});
        report.counts.push_back({"patches", scene_.patches.patches.size()});
        report.counts.push_back({"triangles", scene_.patches.triangles.size()});
    }

    static constexpr std::uint32_t kNone = ~0u;

    const SceneDescription& description_;
    Progress& progress_;
    StageClock clock_;
    AssembledScene scene_;
    std::map<std::string, LoadedTree> trees_;
    std::map<std::pair<std::filesystem::path, std::string>, ObjectTree> objects_;
    std::vector<Thing> things_;
    std::map<std::tuple<const Tree*, std::string, std::string, float, float, float>, MaterialNumbers> dressed_;
    std::vector<SceneSurface> surfaces_; ///< of each of the tree's materials
    std::vector<std::pair<float, float>> heights_;
    std::set<std::string> used_materials_;
    TextureFiles textures_;
};

} // namespace

ShadedScene unlit_scene(const AssembledScene& scene) {
    ShadedScene shaded;
    shaded.patches = &scene.patches;
    shaded.normals = scene.origins.normals;
    shaded.looks = scene.looks;
    shaded.triangle_look = scene.triangle_look;
    shaded.foot_height = scene.foot_height;
    const std::vector<glm::vec3> black(scene.patches.patches.size(), glm::vec3(0.f));
    shaded.indirect_front = shaded.indirect_back = shaded.radiance_front = shaded.radiance_back = black;
    return shaded;
}

AssembledScene assemble_scene(const SceneDescription& description, Progress& progress) {
    return SceneAssembly(description, progress).assemble();
}

} // namespace kokage
