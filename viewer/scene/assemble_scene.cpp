#include "viewer/scene/assemble_scene.h"
#include "common/services/count_text.h"
#include "common/services/named_file.h"
#include "trees/merge_trees.h"
#include "viewer/scene/object_tree.h"
#include "viewer/scene/scene_memory.h"
#include "viewer/scene/scene_messages.h"
#include "viewer/scene/scene_surfaces.h"
#include "viewer/scene/stage_clock.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <limits>
#include <sstream>

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
    SceneAssembly(const SceneDescription& description, const AssemblyOptions& options, Progress& progress)
        : description_(description), options_(options), messages_(description.file), progress_(progress),
          surfaces_(description, messages_) {}

    AssembledScene assemble() {
        clock_.run("check", [&] { check_description(); });
        clock_.run("trees", [&] { load_trees(); });
        clock_.run("objects", [&] { load_objects(); });
        clock_.run("merge", [&] {
            place_all();
            merge();
        });
        progress_.throw_if_stopped();
        clock_.run("environment", [&] { light(); });
        clock_.run("patches", [&] { make_scene(); });
        clock_.run("camera", [&] { set_camera(); });
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

    void check_placement(const Placement& placement, const std::string& pointer) const {
        const auto all_finite = [](const glm::dvec3& v) { return std::isfinite(glm::dot(v, v)); };
        if (!all_finite(placement.at) || !std::isfinite(placement.turn_degrees))
            messages_.fail(pointer, "its place must be finite numbers");
        if (!(placement.size > 0) || !std::isfinite(placement.size))
            messages_.fail(pointer + "/size", "it is " + std::to_string(placement.size) + "; it must be above 0");
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
            leaves += messages_.told_at(placed.pointer, [&] { return asked_leaves(placed); });
        }
        for (const PlacedObject& placed : description_.objects)
            check_placement(placed.placement, placed.pointer);
        if (leaves > double(std::numeric_limits<std::int32_t>::max()))
            messages_.fail("", count_text(std::uint64_t(leaves)) +
                                   " leaves can't be numbered; take fewer trees, or fewer leaves a tree");
        messages_.told_at("", [&] {
            check_memory(estimated_picture_bytes(description_.picture),
                         "a picture of " + std::to_string(description_.picture.width) + " x " +
                             std::to_string(description_.picture.height) + " pixels",
                         description_.picture.samples > 1 ? "make it smaller, or ask for fewer samples"
                                                          : "make it smaller");
            check_memory(estimated_tree_bytes(leaves) + estimated_picture_bytes(description_.picture),
                         "a scene of " + count_text(std::uint64_t(leaves)) + " leaves, with its picture,",
                         "take fewer trees, or fewer leaves a tree");
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
                loaded.tree = messages_.told_at(placed.pointer, [&] {
                    check_tree_source(source);
                    return obtain_tree(source, progress_, true);
                });
                loaded.box = box_of(loaded.tree);
                loaded.foot = foot_of(loaded.tree, loaded.box);
                take_notes(loaded.tree);
                warn_of_missing_foliage(loaded.tree, placed.pointer);
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
                object = messages_.told_at(placed.pointer, [&] {
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
            messages_.fail(placed.pointer + "/height",
                           "it is " + std::to_string(*placed.height_m) + "; it must be above 0");
        if (!(height > 0))
            messages_.fail(placed.pointer + "/height",
                           "'" + placed.file.string() +
                               "' is flat: it has no height that could be scaled; give 'size' "
                               "instead");
        return *placed.height_m / height;
    }

    void warn_of_missing_foliage(const Tree& tree, const std::string& pointer) {
        const char* option = messages_.has_file() ? "'foliage': [NAME]" : "--foliage NAME";
        if (const std::optional<std::string> warning = no_foliage_warning(tree, option))
            scene_.report.warnings.push_back(
                messages_.in_file((messages_.has_file() ? pointer : tree.source) + ": " + *warning));
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
        messages_.told_at("", [&] {
            check_memory(estimated_geometry_bytes(vertices, triangles) + estimated_picture_bytes(description_.picture),
                         "a scene of " + count_text(std::uint64_t(triangles)) + " triangles, with its picture,",
                         "take fewer trees or objects, fewer leaves a tree, or a smaller picture");
        });
        scene_.tree.origin = box.empty() ? glm::dvec3(0.0) : choose_origin(box.low, box.high);
        scene_.foot_height = lowest < kInfinity ? float(lowest - scene_.tree.origin.y) : 0.f;
    }

    Wearer wearer(const Thing& thing) const {
        return {.tree = thing.tree,
                .finishes = thing.finishes,
                .size = thing.placement.size,
                .leaf_material = thing.leaf_material,
                .bark_material = thing.bark_material,
                .pointer = thing.pointer,
                .foot = float(thing.box.low.y - scene_.tree.origin.y),
                .top = float(thing.box.high.y - scene_.tree.origin.y)};
    }

    void merge() {
        scene_.tree.name = description_.name;
        scene_.tree.source = description_.file.string();
        progress_.begin("placing trees and objects", things_.size());
        for (const Thing& thing : things_) {
            progress_.throw_if_stopped();
            add_tree(scene_.tree, *thing.tree, thing.placement, surfaces_.dress(wearer(thing), scene_.tree));
            if (!thing.finishes)
                scene_.tree_parts = scene_.tree.parts.size();
            progress_.advance(1);
        }
        if (!options_.skip_unworn_materials)
            surfaces_.load_unworn();
        trees_.clear();
        objects_.clear();
        things_.clear();
    }

    void light() {
        EnvironmentReport& report = scene_.environment_report;
        scene_.environment = messages_.told_at(messages_.has_file() ? "/environment" : "", [&] {
            return obtain_environment(description_.surroundings, scene_.tree.origin, report, true,
                                      description_.environment_turn_degrees);
        });
        std::vector<std::string>& warnings = scene_.report.warnings;
        warnings.insert(warnings.end(), report.warnings.begin(), report.warnings.end());
        if (const std::optional<std::string> night = night_warning(description_.surroundings))
            scene_.report.warnings.push_back(messages_.in_file(*night));
        if (description_.environment_turn_degrees != 0 && !is_environment_image(description_.surroundings))
            scene_.report.warnings.push_back(
                "the environment's turn changes nothing: it is no image (the sky's sun has "
                "an azimuth of its own)");
    }

    void make_scene() {
        PatchOptions options;
        options.ground = obtain_ground(description_.surroundings, scene_.environment, scene_.foot_height);
        if (options.ground)
            for (const std::string& hidden :
                 drop_hidden_lights(description_.surroundings, scene_.environment, *options.ground))
                scene_.report.warnings.push_back(messages_.in_file(hidden));
        scene_.environment.description += added_lights_text(description_.surroundings, scene_.environment);
        scene_.patches = make_patches(scene_.tree, options, &scene_.origins);
        scene_.triangle_look = scene_.origins.triangle_part;
        scene_.looks = surfaces_.looks(scene_.tree, scene_.report);
        surfaces_.take_gloss_off(scene_.tree, scene_.origins, scene_.patches);
    }

    void set_camera() {
        const CameraDescription& asked = description_.camera;
        const float aspect = float(description_.picture.width) / float(std::max(description_.picture.height, 1));
        const float angle = float(asked.vertical_field_of_view_degrees * kPiDouble / 180);
        if (asked.position && asked.target) {
            scene_.camera.position = glm::vec3(*asked.position - scene_.tree.origin);
            scene_.camera.target = glm::vec3(*asked.target - scene_.tree.origin);
            scene_.camera.vertical_field_of_view = angle;
            check_height_of_camera();
            return;
        }
        if (asked.position || asked.target)
            messages_.fail("/camera", "it has only one of position and target; give both, or neither");
        const float azimuth = asked.azimuth_degrees ? float(*asked.azimuth_degrees * kPiDouble / 180)
                                                    : photographers_azimuth(scene_.environment);
        scene_.camera = frame_scene(scene_.patches, aspect, azimuth, angle);
    }

    /// The ground's underside is black.
    void check_height_of_camera() const {
        std::optional<float> ground;
        if (scene_.patches.ground)
            ground = scene_.patches.ground->height_m;
        else if (description_.picture.ground == PictureGround::automatic)
            ground = scene_.foot_height;
        const double origin = scene_.tree.origin.y;
        if (!ground || !(scene_.camera.position.y < *ground))
            return;
        std::array<char, 160> text;
        std::snprintf(
            text.data(), text.size(),
            "its height, %.4g m, is below the ground's, %.4g m, and the ground is black from below; raise it, "
            "or give \"ground\": false",
            double(scene_.camera.position.y) + origin, double(*ground) + origin);
        messages_.fail("/camera/position", text.data());
    }

    void report() {
        WorkReport& report = scene_.report;
        report.stages = clock_.stages();
        if (options_.skip_unworn_materials)
            surfaces_.report_skips(report);
        report.counts.push_back({"trees", description_.trees.size()});
        report.counts.push_back({"objects", description_.objects.size()});
        report.counts.push_back({"leaves", scene_.tree.leaves.size()});
        report.counts.push_back({"patches", scene_.patches.patches.size()});
        report.counts.push_back({"triangles", scene_.patches.triangles.size()});
    }

    const SceneDescription& description_;
    const AssemblyOptions options_;
    const SceneMessages messages_;
    Progress& progress_;
    StageClock clock_;
    AssembledScene scene_;
    std::map<std::string, LoadedTree> trees_;
    std::map<std::pair<std::filesystem::path, std::string>, ObjectTree> objects_;
    std::vector<Thing> things_;
    SceneSurfaces surfaces_;
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

AssembledScene assemble_scene(const SceneDescription& description, Progress& progress, const AssemblyOptions& options) {
    return SceneAssembly(description, options, progress).assemble();
}

} // namespace kokage
