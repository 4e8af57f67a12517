#include "common/services/byte_hash.h"
#include "common/services/output_file.h"
#include "common/services/uninitialized_vector.h"
#include "reflection/maps/cube_file.h"
#include "reflection/maps/ktx2_layout.h"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <map>

namespace kokage {
namespace ktx2 {

namespace {

// Khronos Data Format 1.3: khr_df.h's names and values.
enum : std::uint32_t {
    KHR_DF_VERSIONNUMBER_1_3 = 2,
    KHR_DF_MODEL_RGBSDA = 1,
    KHR_DF_PRIMARIES_BT709 = 1,
    KHR_DF_TRANSFER_LINEAR = 1,
    KHR_DF_CHANNEL_ALPHA = 15,
    KHR_DF_SAMPLE_DATATYPE_EXPONENT = 0x20,
    KHR_DF_SAMPLE_DATATYPE_SIGNED = 0x40,
    KHR_DF_SAMPLE_DATATYPE_FLOAT = 0x80,
};

struct Sample {
    std::uint32_t bit_offset, bits, channel, lower, upper;
};

std::vector<Sample> samples_of(TexelFormat format) {
    std::vector<Sample> samples;
    if (format == TexelFormat::shared_exponent) {
        // Each colour is a mantissa and the exponent that all share; a mantissa of 8448 with the exponent at its bias
        // is 1.0's place in the formula of section 10.3 (as Khronos' own dfdutils write it).
        for (std::uint32_t channel = 0; channel < 3; ++channel) {
            samples.push_back({9 * channel, 9, channel, 0, 8448});
            samples.push_back({27, 5, channel | KHR_DF_SAMPLE_DATATYPE_EXPONENT, 15, 31});
        }
        return samples;
    }
    const std::uint32_t bits = format == TexelFormat::half_rgb ? 16 : 32;
    for (std::uint32_t i = 0; i < 4; ++i)
        samples.push_back({i * bits, bits,
                           (i == 3 ? std::uint32_t(KHR_DF_CHANNEL_ALPHA) : i) | KHR_DF_SAMPLE_DATATYPE_FLOAT |
                               KHR_DF_SAMPLE_DATATYPE_SIGNED,
                           0xbf800000u, 0x3f800000u}); // -1.0 and 1.0
    return samples;
}

} // namespace

std::vector<unsigned char> data_format_descriptor(TexelFormat format) {
    const std::vector<Sample> samples = samples_of(format);
    const std::size_t block = 24 + 16 * samples.size();
    ByteWriter out;
    out.u32(4 + block);
    out.u32(0); // Khronos' basic descriptor block
    out.u32(KHR_DF_VERSIONNUMBER_1_3 | block << 16);
    out.u32(KHR_DF_MODEL_RGBSDA | KHR_DF_PRIMARIES_BT709 << 8 | KHR_DF_TRANSFER_LINEAR << 16); // alpha straight
    out.u32(0);                                                                                // blocks of one texel
    out.u32(file_texel_bytes(format));
    out.u32(0);
    for (const Sample& s : samples) {
        out.u32(s.bit_offset | (s.bits - 1) << 16 | s.channel << 24);
        out.u32(0);
        out.u32(s.lower);
        out.u32(s.upper);
    }
    return out.bytes;
}

std::string checksum_text(std::string_view lobe, std::string_view parameters, std::span<const unsigned char> levels) {
    const std::string said = std::string(lobe) + " " + std::string(parameters);
    const std::uint64_t start = byte_hash(std::as_bytes(std::span(said)));
    std::array<char, 20> text;
    std::snprintf(text.data(), text.size(), "%016llx",
                  static_cast<unsigned long long>(byte_hash(std::as_bytes(levels), start)));
    return text.data();
}

} // namespace ktx2

namespace {

/// Key/value pairs in the order of their keys, all values text with a final NUL; where the checksum's digits stand.
std::size_t write_key_values(ByteWriter& out, const std::string& lobe, const std::string& parameters) {
    const std::map<std::string, std::string> pairs = {{"KTXorientation", "rd"},
                                                      {"KTXwriter", "kokage " KOKAGE_VERSION},
                                                      {"kokage.checksum", std::string(16, '0')},
                                                      {"kokage.lobe", lobe},
                                                      {"kokage.parameters", parameters}};
    std::size_t digits = 0;
    for (const auto& [key, value] : pairs) {
        out.u32(key.size() + value.size() + 2);
        out.text(key);
        out.u8(0);
        if (key == "kokage.checksum")
            digits = out.bytes.size();
        out.text(value);
        out.u8(0);
        out.align(4);
    }
    return digits;
}

} // namespace

CubeFileBytes ktx2_bytes(const PrefilteredCube& cube, TexelFormat format, const std::string& name) {
    using namespace ktx2;
    check_levels(cube, name);
    check_finite(cube, name);
    const Format& is =
        *std::find_if(kFormats.begin(), kFormats.end(), [&](const auto& f) { return f.format == format; });
    const std::size_t levels = cube.levels.size(), size = std::size_t(cube.levels[0].size);
    const std::vector<unsigned char> descriptor = data_format_descriptor(format);
    const std::string lobe(lobe_kind_name(cube.kind));
    std::string parameters;
    for (const PrefilteredCube::Level& level : cube.levels)
        parameters += (parameters.empty() ? "" : " ") + parameter_text(level);
    ByteWriter key_values;
    const std::size_t digits = write_key_values(key_values, lobe, parameters);

    const std::size_t descriptor_at = kHeaderBytes + kLevelBytes * levels;
    const std::size_t key_values_at = descriptor_at + descriptor.size();
    const std::size_t alignment = level_alignment(format);
    const auto aligned = [&](std::size_t at) { return (at + alignment - 1) / alignment * alignment; };
    const std::size_t levels_at = aligned(key_values_at + key_values.bytes.size());
    std::vector<std::size_t> offsets(levels), lengths(levels);
    std::size_t end = levels_at;
    for (std::size_t i = levels; i-- > 0;) {
        lengths[i] = cube.levels[i].texels.size() * file_texel_bytes(format);
        offsets[i] = aligned(end);
        end = offsets[i] + lengths[i];
    }

    ByteWriter head;
    head.bytes.assign(kIdentifier.begin(), kIdentifier.end());
    for (const std::size_t number : {std::size_t(is.vk_format), std::size_t(is.type_size), size, size, std::size_t(0),
                                     std::size_t(0), std::size_t(6), levels, std::size_t(0)}) // no depth, no layers,
        head.u32(number); // six faces, not supercompressed
    for (const std::size_t number : {descriptor_at, descriptor.size(), key_values_at, key_values.bytes.size()})
        head.u32(number);
    head.u64(0);
    head.u64(0);
    for (std::size_t i = 0; i < levels; ++i) {
        head.u64(offsets[i]);
        head.u64(lengths[i]);
        head.u64(lengths[i]);
    }
    head.bytes.insert(head.bytes.end(), descriptor.begin(), descriptor.end());
    head.bytes.insert(head.bytes.end(), key_values.bytes.begin(), key_values.bytes.end());
    head.bytes.resize(levels_at);

    UninitializedVector<unsigned char> bytes(end);
    std::copy(head.bytes.begin(), head.bytes.end(), bytes.begin());
    CubeFileSummary summary{end, 0};
    for (std::size_t i = 0; i < levels; ++i) {
        const std::size_t next = i == 0 ? end : offsets[i - 1];
        std::fill(bytes.begin() + std::ptrdiff_t(offsets[i] + lengths[i]), bytes.begin() + std::ptrdiff_t(next),
                  static_cast<unsigned char>(0));
        summary.clamped_texels += encode_texels(cube.levels[i].texels, format, bytes.data() + offsets[i]);
    }
    const std::string sum =
        checksum_text(lobe, parameters, std::span<const unsigned char>(bytes.data(), end).subspan(levels_at));
    std::memcpy(bytes.data() + key_values_at + digits, sum.data(), sum.size());

    return {std::move(bytes), summary};
}

CubeFileSummary write_ktx2(const std::filesystem::path& path, const PrefilteredCube& cube, TexelFormat format) {
    const CubeFileBytes made = ktx2_bytes(cube, format, path.string());
    write_file(path, std::span(made.bytes));
    return made.summary;
}

} // namespace kokage
