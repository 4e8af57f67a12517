#include "viewer/bake_options.h"
#include "common/services/error.h"
#include "common/services/memory.h"
#include "common/services/named_file.h"
#include "common/services/output_file.h"
#include "reflection/maps/bake_sequence.h"
#include "reflection/maps/cube_file.h"
#include "reflection/maps/image_sequence.h"
#include "viewer/scene/data_folder.h"
#include "viewer/scene/output_check.h"
#include "viewer/scene/values.h"
#include "viewer/shared_options.h"

#include <algorithm>
#include <cstdio>

namespace kokage {
namespace fs = std::filesystem;
namespace {

void add_map_options(CLI::App& app, BakeOptions& o) {
    app.add_option("--container", o.container,
                   ".exr: shells (a map over all directions for each of a few lobes: smaller and more exact; the "
                   "default) or cube (voxels: direction and smoothness as one vector)")
        ->type_name("NAME")
        ->group("Map");
    app.add_option("--lobe", o.lobe,
                   "phong or ggx (glTF's roughness, seen along the normal); otherwise phong in .exr, ggx in .ktx2 and "
                   ".dds")
        ->type_name("NAME")
        ->group("Map");
    app.add_option("--size", o.size,
                   "cube: voxels along an edge of the whole range (otherwise 128); .ktx2, .dds: texels along an edge "
                   "of the smoothest level (otherwise 256, or what the lobes of a range need). Shells find theirs from "
                   "their lobes")
        ->type_name("N")
        ->group("Map");
    app.add_option("--levels", o.levels,
                   ".ktx2, .dds: mip levels, in equal steps of roughness from 0 or the smooth end of a range to 1 or "
                   "its rough end (otherwise down to 16 texels, five at least where the size allows; .dds: at most 8)")
        ->type_name("N")
        ->group("Map");
    app.add_option("--smoothness", o.smoothness,
                   "Only what is as smooth as A to B, from 0 (rough) to 1: the part of the map that a scene uses, no "
                   "larger than its lobes need. Lookups outside of it give its nearest end")
        ->type_name("A,B")
        ->group("Map");
    app.add_option("--roughness", o.roughness,
                   "The same in glTF's roughness, from 0 (a mirror; .ktx2 and .dds only) to 1: 0.2,0.5")
        ->type_name("A,B")
        ->group("Map");
    app.add_option(
           "--roughness-scale", o.roughness_scale,
           "Phong: which exponent a smoothness stands for, in a cube's voxels and in --smoothness: solved (1 is "
           "the exponent 5000) or paper (u = 6.2 as published: with 128 voxels 1 is 4733)")
        ->type_name("NAME")
        ->capture_default_str()
        ->group("Map");
    app.add_option("--detail", o.detail, "shells: texels in a lobe's width (otherwise 1.15)")
        ->type_name("X")
        ->group("Map");
    app.add_option("--filter", o.filter, "shells: bilinear, or cubic (smoother and more exact; four reads for one)")
        ->type_name("NAME")
        ->capture_default_str()
        ->group("Map");
    app.add_option("--format", o.format, "Texels: half, float or shared-exponent")
        ->type_name("NAME")
        ->capture_default_str()
        ->group("Map");
    app.add_option("--compression", o.compression,
                   ".exr: zip (smallest; the default of a single map), rle, or none (written and read fastest; the "
                   "default of a video). All are lossless")
        ->type_name("NAME")
        ->group("Map");
}

void add_harmonics_options(CLI::App& app, BakeOptions& o) {
    app.add_option("--bands", o.bands, "Bands of harmonics, N x N coefficients (otherwise 3)")
        ->type_name("N")
        ->group("Harmonics (.json)");
    app.add_option("--quantity", o.quantity,
                   "radiance, or irradiance: what a surface with that normal receives (pi under a sky of 1)")
        ->type_name("NAME")
        ->capture_default_str()
        ->group("Harmonics (.json)");
    app.add_flag("--list-lights", o.list_lights,
                 "Sun, lamps and added lights are listed beside the coefficients, which are of the rest; otherwise all "
                 "is in the coefficients")
        ->group("Harmonics (.json)");
}

void add_method_options(CLI::App& app, BakeOptions& o) {
    app.add_option("--method", o.method,
                   "spectral (by spherical harmonics: exact to a tolerance), table (weights on geodesic domes, made "
                   "once: fast, to a few levels of 256 where pixels are at most 1) or brute-force (the truth, slow). "
                   "The first two split the sun "
                   "and lamps off and add them exactly")
        ->type_name("NAME")
        ->capture_default_str()
        ->group("Method");
    app.add_option("--tolerance", o.tolerance,
                   "spectral: largest error of filtering, as a share of 1 or of the brightest light left when lamps "
                   "are split off (otherwise 0.00015, video 0.0003). Rounding to the --format comes to that: 0.0005 of "
                   "a value as "
                   "half, 0.002 as shared-exponent, nothing as float")
        ->type_name("E")
        ->group("Method");
    app.add_option("--threshold", o.threshold,
                   "table: weights below this share of a lobe's peak are left out (otherwise 0.001)")
        ->type_name("TH")
        ->group("Method");
    app.add_option("--weights", o.weights,
                   "table: matched (to each lobe's mean direction), renormalised, or paper (cut, not normalised, no "
                   "lamps split off: loses light and sees small lamps by chance, as published)")
        ->type_name("NAME")
        ->capture_default_str()
        ->group("Method");
    app.add_option("--stored", o.stored,
                   "spectral, table: a file that keeps what does not depend on the light; read if it is there, else "
                   "made")
        ->type_name("FILE")
        ->group("Method");
}

void add_output_options(CLI::App& app, BakeOptions& o) {
    app.add_option("-o,--output", o.output,
                   "The map: .exr (shells or cube), .ktx2 or .dds (a cube map, a roughness a mip level), .json "
                   "(spherical harmonics); for a video a pattern such as maps/%04d.ktx2")
        ->type_name("OUT")
        ->required()
        ->group("Output");
    app.add_option("--broken-frames", o.broken_frames,
                   "Video: what happens at an image that can't be read: skip (left out and named) or stop")
        ->type_name("NAME")
        ->capture_default_str()
        ->group("Output");
    add_report_option(app, o.report)->group("Output");
}

[[noreturn]] void refuse(const std::string& option, const std::string& why) {
    throw InputError(option + ": " + why);
}

void complete_container(BakeOptions& o) {
    const std::string ending = lower_ending(o.output);
    const bool is_cube_map = ending == ".ktx2" || ending == ".dds";
    if (is_cube_map && !o.container.empty())
        refuse("--container", "a " + ending + " holds a cube map; leave it out, or write an .exr");
    if (!o.container.empty() && o.container != "shells" && o.container != "cube")
        refuse("--container", "'" + o.container + "' is not known; give shells or cube");
    o.map.container = is_cube_map             ? MapContainer::cube_map
                      : o.container == "cube" ? MapContainer::voxel_cube
                                              : MapContainer::shells;
    o.map.lobe = o.lobe.empty() ? (is_cube_map ? LobeKind::ggx : LobeKind::phong) : lobe_kind_from_name(o.lobe);
    o.map.format = texel_format_from_name(o.format);
    if (o.map.format == TexelFormat::shared_exponent && (ending == ".dds" || o.container == "cube"))
        refuse("--format", "shared-exponent goes with shells and .ktx2, not with " +
                               std::string(ending == ".dds" ? ".dds" : "a voxel cube") + "; give half or float");
}

/// Harmonics are no map of texels: what shapes those has no place there, and the other way round.
void complete_harmonics(BakeOptions& o) {
    const BakeOptions plain;
    const std::pair<const char*, bool> of_harmonics[] = {{"--bands", o.bands.has_value()},
                                                         {"--quantity", o.quantity != plain.quantity},
                                                         {"--list-lights", o.list_lights}};
    const std::pair<const char*, bool> of_maps[] = {{"--container", !o.container.empty()},
                                                    {"--lobe", !o.lobe.empty()},
                                                    {"--size", o.size.has_value()},
                                                    {"--levels", o.levels.has_value()},
                                                    {"--smoothness", !o.smoothness.empty()},
                                                    {"--roughness", !o.roughness.empty()},
                                                    {"--roughness-scale", o.roughness_scale != plain.roughness_scale},
                                                    {"--detail", o.detail.has_value()},
                                                    {"--filter", o.filter != plain.filter},
                                                    {"--format", o.format != plain.format},
                                                    {"--method", o.method != plain.method},
                                                    {"--tolerance", o.tolerance.has_value()},
                                                    {"--threshold", o.threshold.has_value()},
                                                    {"--weights", o.weights != plain.weights},
                                                    {"--stored", !o.stored.empty()}};
    const bool harmonics = lower_ending(o.output) == ".json";
    for (const auto& [option, given] : of_harmonics)
        if (given && !harmonics)
            refuse(option, "it shapes spherical harmonics; write a .json, or leave it out");
    for (const auto& [option, given] : of_maps)
        if (given && harmonics)
            refuse(option, "it shapes maps of texels, and a .json holds spherical harmonics; leave it out");
    if (!harmonics)
        return;
    o.map.container = MapContainer::harmonics;
    o.map.harmonics.bands = o.bands.value_or(o.map.harmonics.bands);
    o.map.harmonics.quantity = harmonic_quantity_from_name(o.quantity);
    o.map.harmonics.list_lights = o.list_lights;
    if (o.map.harmonics.bands < 1 || o.map.harmonics.bands > HarmonicsSettings::most_bands)
        refuse("--bands", std::to_string(o.map.harmonics.bands) + " is not from 1 to " +
                              std::to_string(HarmonicsSettings::most_bands));
}

void complete_size(BakeOptions& o) {
    const MapContainer container = o.map.container;
    if (o.size && container == MapContainer::shells)
        refuse("--size", "shells are as large as their lobes need; --detail makes them finer, --container cube has a "
                         "size");
    if (o.size && (*o.size < 1 || *o.size > 16384))
        refuse("--size", std::to_string(*o.size) + " is not from 1 to 16384");
    if (o.levels && container != MapContainer::cube_map)
        refuse("--levels", "only .ktx2 and .dds have mip levels; leave it out");
    if (o.levels && *o.levels < 1)
        refuse("--levels", std::to_string(*o.levels) + " levels make no map; give at least 1");
    if (o.levels && *o.levels > kMostDdsLevels && lower_ending(o.output) == ".dds")
        refuse("--levels", "a .dds has room for the roughness of " + std::to_string(kMostDdsLevels) +
                               " levels, not of " + std::to_string(*o.levels) + "; give fewer, or take .ktx2");
    if (o.detail && container != MapContainer::shells)
        refuse("--detail", "it makes shells finer; here --size does");
    if (o.detail && !(*o.detail >= 0.25 && *o.detail <= 16))
        refuse("--detail", "it has to be from 0.25 to 16 texels");
    if (o.filter != "bilinear" && o.filter != "cubic")
        refuse("--filter", "'" + o.filter + "' is not known; give bilinear or cubic");
    if (o.filter == "cubic" && container != MapContainer::shells)
        refuse("--filter", "only shells can be read so; leave it out");
    o.map.size = o.size.value_or(container == MapContainer::voxel_cube ? 128 : 0);
    o.map.levels = o.levels.value_or(0);
    o.map.most_levels = lower_ending(o.output) == ".dds" ? kMostDdsLevels : 0;
    o.map.texels_a_width = o.detail.value_or(o.map.texels_a_width);
    o.map.filter = o.filter == "cubic" ? TexelFilter::cubic : TexelFilter::bilinear;
    o.map.scale = scale_rule_from_name(o.roughness_scale);
    if (o.map.scale == ScaleRule::paper && o.map.lobe != LobeKind::phong)
        refuse("--roughness-scale", "the paper's scale is of Phong's lobe, and this map has GGX's, whose roughness is "
                                    "glTF's; give --lobe phong, or leave it out");
    if (o.map.scale == ScaleRule::paper && container != MapContainer::voxel_cube && o.smoothness.empty())
        refuse("--roughness-scale", "it places the voxels of --container cube and tells what --smoothness means; give "
                                    "one of them, or leave it out");
}

void complete_range(BakeOptions& o) {
    const auto range_from = [](const std::string& text, const char* option, const char* wanted) {
        const std::vector<double> range = numbers_from(text, option);
        if (range.size() != 2 || !(range[0] >= 0 && range[0] <= range[1] && range[1] <= 1))
            refuse(option, "'" + text + "' is not two numbers from " + wanted);
        return std::pair(range[0], range[1]);
    };
    if (!o.smoothness.empty() && !o.roughness.empty())
        refuse("--roughness", "it gives the range that --smoothness gives; leave one of them out");
    if (!o.smoothness.empty()) {
        const auto [a, b] = range_from(o.smoothness, "--smoothness", "0 (rough) to 1, rough first: 0.3,0.6");
        o.map.smoothness = SmoothnessRange{a, b};
    }
    if (!o.roughness.empty()) {
        const auto [a, b] = range_from(o.roughness, "--roughness", "0 (a mirror) to 1, smooth first: 0.2,0.5");
        o.map.roughness = RoughnessRange{a, b};
    }
}

std::string what_fits(const BakeOptions& o, std::uint64_t available) {
    MapSettings smaller = o.map;
    const bool shells = o.map.container == MapContainer::shells;
    const int step = o.map.container == MapContainer::voxel_cube ? 2 : 1; // a voxel cube's size stays even
    smaller.levels = 0;
    smaller.size = o.plan.size;
    if (o.map.container == MapContainer::voxel_cube)
        smaller.size = o.map.size;
    for (int halvings = 1; halvings < 10; ++halvings) {
        smaller.texels_a_width /= 2;
        smaller.size = std::max(smaller.size / 2 / step * step, 4);
        if (shells && smaller.texels_a_width < 0.25)
            break;
        const std::uint64_t needed = plan_map(smaller).peak_bytes;
        if (needed > available)
            continue;
        char text[80];
        if (shells)
            std::snprintf(text, sizeof text, "--detail %.3g would take ", smaller.texels_a_width);
        else
            std::snprintf(text, sizeof text, "--size %d would take ", smaller.size);
        return text + bytes_text(double(needed));
    }
    return "even the smallest takes more than there is";
}

/// Plans the map, and refuses what this machine's memory can't hold.
void complete_plan(BakeOptions& o) {
    o.plan = plan_map(o.map);
    const std::uint64_t available = available_memory_bytes();
    if (o.plan.peak_bytes <= available)
        return;
    refuse(o.map.container == MapContainer::shells ? "--detail" : "--size",
           "baking this map takes about " + bytes_text(double(o.plan.peak_bytes)) + " of memory, and " +
               bytes_text(double(available)) + " are free here; " + what_fits(o, available));
}

void complete_method(BakeOptions& o) {
    o.baker.method = bake_method_from_name(o.method);
    const bool spectral = o.baker.method == BakeMethod::spectral, table = o.baker.method == BakeMethod::table;
    if (o.tolerance && !spectral)
        refuse("--tolerance", table ? "the table can't aim at an error; give a --threshold, or --method spectral"
                                    : "brute-force is exact; leave it out");
    if (o.tolerance && !(*o.tolerance >= 1e-5 && *o.tolerance <= 0.1))
        refuse("--tolerance", "it has to be from 0.00001, which sums of floats can hold, to 0.1; finer than that is "
                              "only --method brute-force");
    if (!table && (o.threshold || o.weights != "matched"))
        refuse(o.threshold ? "--threshold" : "--weights", "it shapes the table alone; add --method table");
    if (!o.stored.empty() && !spectral && !table)
        refuse("--stored", "brute-force prepares nothing that could be kept; leave it out");
    o.baker.tolerance = o.tolerance.value_or(o.is_sequence ? kVideoTolerance : o.baker.tolerance);
    o.baker.table.threshold = o.threshold.value_or(o.baker.table.threshold);
    o.baker.table.weights = table_weights_from_name(o.weights);
    o.baker.stored_setup = o.stored;
}

void complete_compression(BakeOptions& o) {
    const bool exr = o.map.container == MapContainer::shells || o.map.container == MapContainer::voxel_cube;
    if (!exr && !o.compression.empty())
        refuse("--compression", "only .exr files are compressed; leave it out");
    if (exr && o.compression.empty())
        o.compression = o.is_sequence ? "none" : "zip";
    if (exr && o.compression != "zip" && o.compression != "rle" && o.compression != "none")
        refuse("--compression", "'" + o.compression + "' is not known; give zip, rle or none");
    o.map.compression = o.compression == "rle"   ? ExrCompression::rle
                        : o.compression == "zip" ? ExrCompression::zip
                                                 : ExrCompression::none;
}

void complete_outputs(BakeOptions& o) {
    const bool numbered = has_number_place(fs::path(o.output).filename().string());
    if (o.is_sequence && !numbered)
        refuse("-o", "'" + o.output + "' has no place for the frames' numbers; give a pattern such as maps/%04d" +
                         lower_ending(o.output));
    if (o.broken_frames != "skip" && o.broken_frames != "stop")
        refuse("--broken-frames", "'" + o.broken_frames + "' is not known; give skip or stop");
    if (o.is_sequence) {
        const std::string ending = lower_ending(o.output);
        if (ending != ".exr" && ending != ".ktx2" && ending != ".dds" && ending != ".json")
            refuse("-o", "the maps can't be '" + o.output + "'; give one of .exr, .ktx2, .dds, .json");
        const fs::path frames(o.surroundings.environment), maps = fs::absolute(o.output).parent_path();
        if (fs::is_directory(frames) && fs::weakly_canonical(frames) == fs::weakly_canonical(maps))
            refuse("-o",
                   "the maps would lie among the frames, and the next run take them for frames; give another folder");
    } else {
        if (numbered)
            refuse("-o", "'" + o.output + "' has a place for frames' numbers, but '" + o.surroundings.environment +
                             "' is one environment; give a folder of images, a list (.txt) or a pattern");
        check_output(o.output, "the map", {".exr", ".ktx2", ".dds", ".json"});
        check_distinct({fs::path(o.surroundings.environment), fs::path(o.output), o.report, o.stored});
    }
    if (!o.report.empty())
        check_output(o.report, "the report", {".json"});
    if (!o.stored.empty() && !fs::exists(o.stored))
        const OutputFile probe(o.stored); // finds now what would lose the work later
}

} // namespace

void add_bake_options(CLI::App& app, BakeOptions& o) {
    app.add_option("ENV", o.surroundings.environment,
                   "What is reflected: a lat-long image (.hdr, .exr, .png, ...), twice as wide as high; sky, "
                   "constant[:R,G,B] or gradient[:nine numbers]; or a video: a pattern (frames/%04d.hdr), a folder of "
                   "images, a list of them (.txt)")
        ->type_name("ENV")
        ->required();
    add_data_option(app, o.data, "ENV is");
    add_map_options(app, o);
    add_harmonics_options(app, o);
    add_method_options(app, o);
    add_light_options(app, o.surroundings);
    add_output_options(app, o);
}

void complete_bake_options(BakeOptions& o) {
    o.surroundings.words.environment = "ENV";
    find_in_data(o.data, {&o.surroundings.environment});
    complete_harmonics(o);
    if (o.map.container != MapContainer::harmonics) {
        complete_container(o);
        complete_size(o);
        complete_range(o);
    }
    o.is_sequence = names_a_sequence(o.surroundings.environment);
    complete_method(o);
    complete_outputs(o);
    complete_compression(o);
    complete_plan(o);
    if (!o.is_sequence)
        check_surroundings(o.surroundings, o.data);
    else if (!o.surroundings.sun.empty() || o.surroundings.turbidity)
        throw InputError("--sun and --turbidity shape the sky, not a video; add a light: --light sun:AZ,EL,R,G,B");
    for (const std::string& light : o.surroundings.lights)
        if (light.starts_with("point"))
            refuse("--light", "'" + light +
                                  "' is at a place, and a map holds light from infinitely far; give sun, "
                                  "disc or directional");
}

} // namespace kokage
