#include "viewer/shade_lods.h"

#include "common/scene/image_file.h"
#include "common/services/error.h"
#include "reflection/compare_images.h"
#include "reflection/impostor.h"
#include "trees/levels_of_detail.h"
#include "viewer/scene/shaded_scene.h"
#include "viewer/write_json.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

namespace kokage {
namespace fs = std::filesystem;
namespace {

constexpr int picture_samples = 8;
/// From where it is looked at, against the impostor's first card: between cards, near one and far from one.
constexpr float view_offsets[] = {0.25f, 0.95f};

/// A view before an even background.
Image before_background(const CapturedView& view, const glm::vec3& background) {
    Image image(view.color.width, view.color.height, 3);
    for (std::size_t i = 0; i < view.alpha.pixels.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c)
            image.pixels[3 * i + c] = glm::mix(background[c], view.color.pixels[3 * i + c], view.alpha.pixels[i]);
    return image;
}

/// Every side halved `times` times (rows and columns left over are dropped).
Image halved(Image image, int times) {
    for (; times > 0 && image.width > 1 && image.height > 1; --times) {
        Image half(image.width / 2, image.height / 2, image.channels);
        for (int y = 0; y < half.height; ++y)
            for (int x = 0; x < half.width; ++x)
                for (int c = 0; c < half.channels; ++c)
                    half.at(x, y)[c] = 0.25f * (image.at(2 * x, 2 * y)[c] + image.at(2 * x + 1, 2 * y)[c] +
                                                image.at(2 * x, 2 * y + 1)[c] + image.at(2 * x + 1, 2 * y + 1)[c]);
        image = std::move(half);
    }
    return image;
}

/// What is seen of one level from one side.
struct Seen {
    Image picture; ///< before the background
    Image alpha;
};

/// Relative error of every pixel, the mean of its channels: |x - ref| / max(ref, 0.05 mean ref), as errors of leaves
/// are given. Pixels that show neither tree are -1.
Image relative_error(const Seen& seen, const Seen& full) {
    glm::dvec3 mean(0.0);
    const std::size_t count = full.alpha.pixels.size();
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t c = 0; c < 3; ++c)
            mean[c] += double(full.picture.pixels[3 * i + c]) / double(count);
    Image error(full.picture.width, full.picture.height, 1);
    for (std::size_t i = 0; i < count; ++i) {
        double sum = 0;
        for (std::size_t c = 0; c < 3; ++c) {
            const double reference = double(full.picture.pixels[3 * i + c]);
            sum += std::abs(double(seen.picture.pixels[3 * i + c]) - reference) /
                   std::max({reference, 0.05 * mean[c], 1e-30});
        }
        error.pixels[i] = seen.alpha.pixels[i] + full.alpha.pixels[i] > 0 ? float(sum / 3) : -1.f;
    }
    return error;
}

/// Mean luminance of what is seen of the tree itself.
double tree_luminance(const Seen& seen, const glm::vec3& background) {
    double sum = 0, weight = 0;
    for (std::size_t i = 0; i < seen.alpha.pixels.size(); ++i) {
        const float alpha = seen.alpha.pixels[i];
        const glm::vec3 color(seen.picture.pixels[3 * i], seen.picture.pixels[3 * i + 1],
                              seen.picture.pixels[3 * i + 2]);
        sum += double(luminance(color - (1 - alpha) * background));
        weight += double(alpha);
    }
    return weight > 0 ? sum / weight : 0;
}

double mean_error(const Seen& seen, const Seen& full) {
    double sum = 0;
    std::size_t count = 0;
    for (const float value : relative_error(seen, full).pixels)
        if (value >= 0) {
            sum += double(value);
            ++count;
        }
    return count ? sum / double(count) : 0;
}

/// The error in the colours of error_legend; display-ready.
Image error_map(const Seen& seen, const Seen& full) {
    const Image error = relative_error(seen, full), legend = error_legend(256, 1);
    Image map(error.width, error.height, 3);
    for (std::size_t i = 0; i < error.pixels.size(); ++i) {
        const float* color = legend.at(std::clamp(int(255 * error.pixels[i]), 0, 255), 0);
        std::copy_n(color, 3, map.pixels.begin() + std::ptrdiff_t(3 * i));
    }
    return map;
}

void paste(const Image& from, int x0, int y0, Image& into) {
    for (int y = 0; y < from.height; ++y)
        std::copy_n(from.at(0, y), std::size_t(from.width) * 3, into.at(x0, y0 + y));
}

/// Radiance of the open sky, evened out: what the tree is shown before.
glm::vec3 background_of(const Environment& environment) {
    const Image& sky = environment.remainder;
    glm::dvec3 sum(0.0);
    double weight = 0;
    for (int y = 0; y < std::max(1, sky.height / 2); ++y) {
        const double w = std::sin(kPiDouble * (y + 0.5) / sky.height);
        for (int x = 0; x < sky.width; ++x) {
            sum += w * glm::dvec3(sky.at(x, y)[0], sky.at(x, y)[1], sky.at(x, y)[2]);
            weight += w;
        }
    }
    return glm::vec3(sum / weight);
}

std::size_t triangle_count(const Tree& tree) {
    std::size_t count = 0;
    for (const TreePart& part : tree.parts)
        count += part.triangles.size();
    return count;
}

/// Mean luminance of the leaf sides, by area.
double mean_leaf_radiance(const ShadedAttributes& light, const std::vector<double>& areas, std::size_t leaves) {
    double sum = 0, weight = 0;
    for (std::size_t i = 0; i < leaves; ++i) {
        sum += areas[i] * 0.5 * double(luminance(light.radiance_front[i]) + luminance(light.radiance_back[i]));
        weight += areas[i];
    }
    return weight > 0 ? sum / weight : 0;
}

class LodWriter {
  public:
    LodWriter(const ShadedTree& shaded, const LodOptions& options, Progress& progress)
        : shaded_(shaded), options_(options), progress_(progress),
          azimuth_(photographers_azimuth(shaded.environment) - view_offsets[0]),
          background_(background_of(shaded.environment)) {
        frame_ = frame_of(shaded.patches, azimuth_);
        width_ = std::clamp(
            int(std::lround(options.picture_height * double(frame_.half_width) / double(frame_.half_height))), 16,
            4 * options.picture_height);
        height_ = options.picture_height;
    }

    WrittenLods write() {
        std::error_code ignored;
        fs::create_directories(options_.folder, ignored);
        progress_.begin("levels of detail", std::size_t(options_.levels) + 2);
        write_full();
        for (int level = 1; level <= options_.levels; ++level)
            write_level(level);
        write_impostor_level();
        finish_picture();
        const fs::path report = file("_lods.json");
        write_json(report, {{"levels", levels_},
                            {"what",
                             {{"mean_leaf_radiance", "luminance, mean over leaf sides by area"},
                              {"covered", "share of the picture that shows the tree"},
                              {"seen_luminance", "mean luminance of the tree in the picture"},
                              {"image_mre", "mean over the pixels that show a tree and over two sides of |x - ref| "
                                            "/ max(ref, 0.05 mean ref), at full size"},
                              {"image_mre_from_afar", "the same from `times_as_far`, for which the level is meant"}}}});
        files_.push_back(report);
        return {files_, figures_};
    }

  private:
    fs::path file(const std::string& ending) const { return options_.folder / (options_.stem + ending); }

    std::vector<Seen> look_at(const ShadedScene& scene, const RayQueries& queries) {
        std::vector<Seen> views;
        for (const float offset : view_offsets) {
            ViewFrame frame = frame_;
            const float azimuth = azimuth_ + offset;
            frame.towards_viewer = {std::sin(azimuth), 0, std::cos(azimuth)};
            const CapturedView view =
                capture_view(scene, queries, shaded_.environment, frame, width_, height_, picture_samples, progress_);
            views.push_back({before_background(view, background_), view.alpha});
        }
        return views;
    }

    /// Errors against the full tree, and the level's row in the report.
    void add_figures(nlohmann::ordered_json row, std::vector<Seen> views, int halvings) {
        double near = 0, afar = 0, covered = 0, radiance = 0;
        for (std::size_t v = 0; v < views.size(); ++v) {
            const Seen& full = views_.empty() ? views[v] : views_[0][v];
            covered += coverage(views[v].alpha) / double(views.size());
            radiance += tree_luminance(views[v], background_) / double(views.size());
            near += mean_error(views[v], full) / double(views.size());
            afar += mean_error({halved(views[v].picture, halvings), halved(views[v].alpha, halvings)},
                               {halved(full.picture, halvings), halved(full.alpha, halvings)}) /
                    double(views.size());
        }
        row["covered"] = covered;
        row["seen_luminance"] = radiance;
        row["image_mre"] = near;
        row["times_as_far"] = 1 << halvings;
        row["image_mre_from_afar"] = afar;
        figures_.push_back({.file = row["file"],
                            .leaves = row["leaves"],
                            .triangles = row["triangles"],
                            .image_mre = near,
                            .times_as_far = 1 << halvings,
                            .image_mre_from_afar = afar});
        levels_.push_back(std::move(row));
        views_.push_back(std::move(views));
        progress_.advance(1);
    }

    nlohmann::ordered_json row_of(const fs::path& path, const Tree& tree, double leaf_area, double bark_area,
                                  double radiance) const {
        return {{"file", path.filename().string()}, {"leaves", tree.leaves.size()}, {"triangles", triangle_count(tree)},
                {"bytes", fs::file_size(path)},     {"leaf_area_m2", leaf_area},    {"bark_area_m2", bark_area},
                {"mean_leaf_radiance", radiance}};
    }

    void write_full() {
        const Solution& solution = shaded_.solution;
        light_ = {.radiance_front = solution.radiance.front,
                  .radiance_back = solution.radiance.back,
                  .indirect_front = solution.indirect.front,
                  .indirect_back = solution.indirect.back,
                  .light_maps = solution.light_maps};
        write_mesh(level_of_detail(shaded_.tree, 0), light_, 0, shaded_.patches, shaded_.origins);
    }

    void write_level(int level) {
        const LevelOfDetail lod = level_of_detail(shaded_.tree, level);
        PatchOrigins origins;
        const PatchScene patches = make_patches(lod.tree, {}, &origins);
        write_mesh(lod, transfer_light(shaded_.tree, light_, lod), level, patches, origins);
    }

    void write_mesh(const LevelOfDetail& lod, const ShadedAttributes& light, int level, const PatchScene& patches,
                    const PatchOrigins& origins) {
        const fs::path path = file("_lod" + std::to_string(level) + ".glb");
        write_tree(path, lod.tree, &light, {.split_sides = options_.split_sides});
        files_.push_back(path);
        Solution solution;
        solution.radiance = {light.radiance_front, light.radiance_back};
        solution.indirect = {light.indirect_front, light.indirect_back};
        const ShadedScene scene = shaded_scene(lod.tree, patches, origins, solution);
        const RayQueries queries(patches);
        const double radiance = mean_leaf_radiance(light, solid_areas(make_patches(lod.tree)), lod.tree.leaves.size());
        add_figures(row_of(path, lod.tree, lod.leaf_area, lod.bark_area, radiance), look_at(scene, queries), level);
        if (level == 0)
            impostor_ =
                make_impostor(scene, queries, shaded_.environment, options_.cards, height_, azimuth_, progress_);
    }

    void write_impostor_level() {
        const fs::path path = file("_impostor.glb");
        write_impostor(path, *impostor_, shaded_.tree.name);
        files_.push_back(path);
        ImpostorScene scene;
        make_impostor_scene(*impostor_, scene);
        const RayQueries queries(scene.patches);
        add_figures({{"file", path.filename().string()},
                     {"leaves", 0},
                     {"triangles", scene.patches.triangles.size()},
                     {"bytes", fs::file_size(path)}},
                    look_at(scene.shaded, queries), options_.levels);
    }

    void finish_picture() {
        constexpr int gap = 4;
        const int columns = int(views_.size());
        const float exposure = automatic_exposure_stops(views_[0][0].picture);
        Image sheet(columns * (width_ + gap) - gap, 3 * (height_ + gap) - gap, 3);
        std::fill(sheet.pixels.begin(), sheet.pixels.end(), 0.5f);
        for (int column = 0; column < columns; ++column) {
            const Seen& seen = views_[std::size_t(column)][0];
            const int x = column * (width_ + gap), times = levels_[std::size_t(column)]["times_as_far"].get<int>();
            paste(tone_map(seen.picture, exposure), x, 0, sheet);
            paste(error_map(seen, views_[0][0]), x, height_ + gap, sheet);
            const Image afar = tone_map(halved(seen.picture, int(std::lround(std::log2(times)))), exposure);
            paste(afar, x + (width_ - afar.width) / 2, 2 * (height_ + gap) + (height_ - afar.height) / 2, sheet);
        }
        const fs::path path = file("_lods.png");
        save_image(path, sheet, {.png_encoding = PngEncoding::as_is});
        files_.push_back(path);
    }

    const ShadedTree& shaded_;
    const LodOptions& options_;
    Progress& progress_;
    float azimuth_;
    glm::vec3 background_;
    ViewFrame frame_;
    int width_ = 0, height_ = 0;
    ShadedAttributes light_;
    std::optional<Impostor> impostor_;
    nlohmann::ordered_json levels_ = nlohmann::ordered_json::array();
    std::vector<LodFigures> figures_;
    std::vector<std::vector<Seen>> views_; ///< per level, per side
    std::vector<fs::path> files_;
};

} // namespace

void check_lod_folder(const fs::path& folder) {
    std::error_code error;
    if (fs::exists(folder, error) && !fs::is_directory(folder, error))
        throw InputError("--lods: '" + folder.string() + "' is a file; name a folder");
    fs::create_directories(folder, error);
    if (error || !fs::is_directory(folder))
        throw InputError("--lods: the folder '" + folder.string() +
                         "' can't be made; name one in a place that can be "
                         "written");
}

WrittenLods write_lods(const ShadedTree& shaded, const LodOptions& options, Progress& progress) {
    return LodWriter(shaded, options, progress).write();
}

} // namespace kokage
