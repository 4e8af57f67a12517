#include "reflection/maps/map_file.h"

#include "common/services/error.h"
#include "common/services/named_file.h"
#include "common/services/number_text.h"
#include "reflection/maps/exr_notes.h"
#include "reflection/maps/shell_atlas.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

namespace kokage {
namespace {

constexpr const char* kVersion = "2";
constexpr const char *kShells = "shells", *kCube = "voxel cube";

const char* filter_name(TexelFilter filter) {
    return filter == TexelFilter::cubic ? "cubic" : "bilinear";
}

std::string shells_text(std::span<const ShellMap::Shell> shells, const ShellAtlas& atlas) {
    std::string text;
    for (std::size_t i = 0; i < shells.size(); ++i)
        text += (i ? "; " : "") + number_text(shells[i].lobe.parameter) + " " + number_text(double(shells[i].width)) +
                " " + std::to_string(shells[i].resolution) + " " + std::to_string(atlas.places[i].x) + " " +
                std::to_string(atlas.places[i].y);
    return text;
}

void check_finite(std::span<const float> values, int width, const std::filesystem::path& path) {
    constexpr std::uint32_t exponent = 0x7f800000u; // all of it is set in infinities and NaNs
    std::uint32_t bad = 0;                          // integers, and no way out of the loop: it is done by vectors
    for (const float value : values)
        bad |= std::uint32_t((std::bit_cast<std::uint32_t>(value) & exponent) == exponent);
    if (!bad)
        return;
    const auto first = std::find_if_not(values.begin(), values.end(), [](float v) { return std::isfinite(v); });
    const std::size_t pixel = std::size_t(first - values.begin()) / 3;
    throw InputError("cannot write map '" + path.string() + "': its pixel (" +
                     std::to_string(pixel % std::size_t(width)) + ", " + std::to_string(pixel / std::size_t(width)) +
                     ") is not finite; bake the map again");
}

std::function<void()> writing(const std::filesystem::path& path, ExrPixels pixels, ExrNotes notes,
                              const std::string& made_from, ExrCompression compression) {
    if (!made_from.empty())
        notes["made_from"] = made_from;
    return [=, pixels = std::move(pixels), notes = std::move(notes)] {
        write_noted_exr(path, pixels, notes, compression);
    };
}

/// What a map's notes say, checked.
class NotesReader {
  public:
    NotesReader(const ExrNotes& notes, std::string name) : notes_(notes), name_(std::move(name)) {}
    [[noreturn]] void fail(const std::string& why) const {
        throw InputError("cannot read map '" + name_ + "': " + why + "; bake it again");
    }
    const std::string& text(const std::string& key) const {
        const auto found = notes_.find(key);
        if (found == notes_.end())
            fail("its header lacks kokage:" + key);
        return found->second;
    }
    double number(const std::string& key) const {
        const auto value = number_from_text(text(key));
        if (!value)
            fail("its kokage:" + key + " is '" + text(key) + "', not a number");
        return *value;
    }
    template <typename Value>
    Value one_of(const std::string& key, std::initializer_list<std::pair<const char*, Value>> names) const {
        for (const auto& [name, value] : names)
            if (text(key) == name)
                return value;
        fail("its kokage:" + key + " is '" + text(key) + "', which this program does not know");
    }
    SmoothnessRange smoothness() const {
        const std::string& range = text("smoothness");
        const std::size_t space = std::min(range.find(' '), range.size());
        const auto roughest = number_from_text(range.substr(0, space));
        const auto smoothest = number_from_text(range.substr(std::min(space + 1, range.size())));
        if (!roughest || !smoothest)
            fail("its kokage:smoothness is '" + range + "', not two numbers");
        return {*roughest, *smoothest};
    }
    LobeKind lobe() const { return one_of<LobeKind>("lobe", {{"phong", LobeKind::phong}, {"ggx", LobeKind::ggx}}); }
    TexelFormat format() const {
        return one_of<TexelFormat>("format", {{"half", TexelFormat::half_rgb},
                                              {"float", TexelFormat::float_rgb},
                                              {"shared-exponent", TexelFormat::shared_exponent}});
    }

  private:
    const ExrNotes& notes_;
    std::string name_;
};

void check_size(const NotesReader& notes, const ExrHeader& header, int width, int height) {
    if (header.width != width || header.height != height)
        notes.fail("it is " + std::to_string(header.width) + " x " + std::to_string(header.height) +
                   " pixels, but its header describes a map of " + std::to_string(width) + " x " +
                   std::to_string(height));
}

ShellMap read_shells(const ExrHeader& header, const NotesReader& notes, const std::filesystem::path& path) {
    ShellSettings settings;
    settings.kind = notes.lobe();
    settings.format = notes.format();
    settings.filter =
        notes.one_of<TexelFilter>("filter", {{"bilinear", TexelFilter::bilinear}, {"cubic", TexelFilter::cubic}});
    settings.least_parameter = notes.number("least_parameter");
    settings.most_parameter = notes.number("most_parameter");
    settings.shell_ratio = notes.number("shell_ratio");
    settings.texels_a_width = notes.number("texels_a_width");
    std::vector<ShellMap::Shell> shells;
    try {
        shells = ShellMap::plan(settings);
    } catch (const InputError& error) {
        notes.fail(std::string("its header describes no map (") + error.what() + ")");
    }
    const ShellAtlas atlas = shell_atlas(shells, ShellMap::border(settings.filter));
    check_size(notes, header, atlas.width, atlas.height);
    const Image image = read_noted_exr(path, header);
    ShellMap map(settings);
    set_atlas_image(map, atlas, image);
    return map;
}

int cube_width(const NotesReader& notes, double size, const SmoothnessRange& range) {
    try {
        return VoxelCube::extent(int(size), range).size;
    } catch (const InputError& error) {
        notes.fail(std::string("its header describes no map (") + error.what() + ")");
    }
}

VoxelCube read_cube(const ExrHeader& header, const NotesReader& notes, const std::filesystem::path& path) {
    const double size = notes.number("cube_size");
    if (!(size >= 4 && size <= 1022 && size == std::floor(size)))
        notes.fail("its kokage:cube_size is '" + notes.text("cube_size") + "'");
    const SmoothnessRange range = notes.smoothness();
    const int width = cube_width(notes, size, range);
    check_size(notes, header, width, width * width);
    const Image image = read_noted_exr(path, header);
    try {
        VoxelCube cube(notes.lobe(), RoughnessScale::with_u(notes.number("u"), int(size), notes.number("levels")),
                       range);
        std::vector<glm::vec3> texels;
        for (const std::size_t voxel : cube.voxel_of_texel())
            texels.emplace_back(image.pixels[3 * voxel], image.pixels[3 * voxel + 1], image.pixels[3 * voxel + 2]);
        cube.set_texels(texels);
        return cube;
    } catch (const InputError& error) {
        notes.fail(error.what());
    }
}

} // namespace

std::function<void()> packed_map(const std::filesystem::path& path, const ShellMap& map, const std::string& made_from,
                                 ExrCompression compression) {
    const ShellSettings& settings = map.settings();
    const ShellAtlas atlas = shell_atlas(map.shells(), map.border());
    const Image image = atlas_image(map, atlas);
    check_finite(image.pixels, image.width, path);
    ExrNotes notes = {{"map", kShells},
                      {"layout_version", kVersion},
                      {"lobe", std::string(lobe_kind_name(settings.kind))},
                      {"format", std::string(texel_format_name(settings.format))},
                      {"filter", filter_name(settings.filter)},
                      {"least_parameter", number_text(settings.least_parameter)},
                      {"most_parameter", number_text(settings.most_parameter)},
                      {"shell_ratio", number_text(settings.shell_ratio)},
                      {"texels_a_width", number_text(settings.texels_a_width)},
                      {"shells", shells_text(map.shells(), atlas)}};
    return writing(path, exr_pixels(image, settings.format != TexelFormat::float_rgb), std::move(notes), made_from,
                   compression);
}

std::function<void()> packed_map(const std::filesystem::path& path, const VoxelCube& cube, TexelFormat format,
                                 const std::string& made_from, ExrCompression compression) {
    if (format == TexelFormat::shared_exponent)
        throw InputError("cannot write map '" + path.string() + "': voxels are kept as halves or floats");
    check_finite({&cube.voxels().front().x, 3 * cube.voxels().size()}, cube.size(), path);
    ExrPixels pixels{cube.size(), cube.size() * cube.size(), format == TexelFormat::half_rgb,
                     packed_texels(cube.voxels(), format), cube.size()};
    ExrNotes notes = {{"map", kCube},
                      {"layout_version", kVersion},
                      {"lobe", std::string(lobe_kind_name(cube.layout().kind))},
                      {"format", std::string(texel_format_name(format))},
                      {"cube_size", std::to_string(cube.scale().cube_size())},
                      {"levels", number_text(cube.scale().levels())},
                      {"smoothness", number_text(cube.range().roughest) + " " + number_text(cube.range().smoothest)},
                      {"u", number_text(cube.scale().u())}};
    return writing(path, std::move(pixels), std::move(notes), made_from, compression);
}

void write_map(const std::filesystem::path& path, const ShellMap& map, const std::string& made_from,
               ExrCompression compression) {
    packed_map(path, map, made_from, compression)();
}

void write_map(const std::filesystem::path& path, const VoxelCube& cube, TexelFormat format,
               const std::string& made_from, ExrCompression compression) {
    packed_map(path, cube, format, made_from, compression)();
}

MapFile read_map(const std::filesystem::path& path) {
    const ExrHeader header = read_exr_header(path);
    const NotesReader notes(header.notes, path.string());
    if (!header.notes.count("map"))
        throw InputError("cannot read map '" + path.string() +
                         "': it is a picture without the attributes of a map; give an .exr that kokage bake wrote");
    if (notes.text("layout_version") != kVersion)
        notes.fail("its layout has the version '" + notes.text("layout_version") + "', this program reads version " +
                   kVersion);
    const std::string made_from = header.notes.count("made_from") ? notes.text("made_from") : "";
    if (notes.text("map") == kShells)
        return {read_shells(header, notes, path), made_from};
    if (notes.text("map") == kCube)
        return {read_cube(header, notes, path), made_from};
    notes.fail("it holds '" + notes.text("map") + "', which is neither shells nor a voxel cube");
}

bool is_map_file(const std::filesystem::path& path) {
    try {
        return read_exr_header(path).notes.count("map") > 0;
    } catch (const InputError&) {
        return false;
    }
}

void check_is_no_map(const std::filesystem::path& path) {
    if (lower_ending(path) == ".exr" && is_map_file(path))
        throw InputError("'" + path.string() +
                         "' is a reflection map that kokage bake wrote, no image of surroundings; give the image that "
                         "it was made from");
}

} // namespace kokage
