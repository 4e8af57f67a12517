#include "tests/benchmark/reference.h"
#include "common/services/error.h"
#include "common/services/output_file.h"
#include "tests/benchmark/radiance_code.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

namespace kokage {

namespace {

constexpr const char* kReferenceFormat = "kokage leaf side reference 1";
constexpr const char* kSumsFormat = "kokage reference sums 1";

std::string hexadecimal(std::uint64_t value) {
    char digits[17];
    std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(value));
    return digits;
}

std::string read_whole(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// The header of a file and where its data begin; an empty header if it is not of this format.
struct Parsed {
    nlohmann::json header;
    std::size_t data = 0;
};
Parsed parse(const std::string& contents, const char* format) {
    const std::size_t first_end = contents.find('\n');
    if (first_end == std::string::npos || contents.compare(0, first_end, format) != 0)
        return {};
    const std::size_t second_end = contents.find('\n', first_end + 1);
    if (second_end == std::string::npos)
        return {};
    return {nlohmann::json::parse(contents.begin() + std::ptrdiff_t(first_end) + 1,
                                  contents.begin() + std::ptrdiff_t(second_end), nullptr, false),
            second_end + 1};
}

} // namespace

void save_reference(const std::filesystem::path& path, const Reference& reference) {
    const nlohmann::json header{{"scene_hash", hexadecimal(reference.scene_hash)},
                                {"paths_per_side", reference.paths_per_side},
                                {"noise", reference.noise},
                                {"sides", reference.sides.size()}};
    std::string contents = std::string(kReferenceFormat) + "\n" + header.dump() + "\n";
    for (glm::length_t channel = 0; channel < 3; ++channel)
        for (const glm::vec3& side : reference.sides) {
            const std::uint16_t code = radiance_code(side[channel]);
            contents.push_back(char(code & 0xff));
            contents.push_back(char(code >> 8));
        }
    write_file(path, contents);
}

std::optional<Reference> load_reference(const std::filesystem::path& path) {
    if (!std::filesystem::exists(path))
        return std::nullopt;
    const std::string contents = read_whole(path);
    const auto [header, data] = parse(contents, kReferenceFormat);
    const auto damaged = [&] {
        return InputError("reference " + path.string() +
                          " is damaged or of another format: remove it, and it is made again");
    };
    try {
        Reference reference;
        reference.scene_hash = std::stoull(header.at("scene_hash").get<std::string>(), nullptr, 16);
        reference.paths_per_side = header.at("paths_per_side");
        reference.noise = header.at("noise");
        const std::size_t count = header.at("sides");
        if (contents.size() - data != count * 6)
            throw damaged();
        reference.sides.resize(count);
        for (std::size_t channel = 0; channel < 3; ++channel)
            for (std::size_t side = 0; side < count; ++side) {
                const std::size_t at = data + 2 * (channel * count + side);
                const auto low = static_cast<unsigned char>(contents[at]),
                           high = static_cast<unsigned char>(contents[at + 1]);
                reference.sides[side][glm::length_t(channel)] = radiance_from_code(std::uint16_t(low | high << 8));
            }
        return reference;
    } catch (const nlohmann::json::exception&) {
        throw damaged();
    } catch (const std::logic_error&) { // stoull
        throw damaged();
    }
}

Reference ReferenceSums::reference() const {
    Reference result;
    result.scene_hash = scene_hash;
    result.paths_per_side = 2 * paths_per_chunk * chunks;
    const double scale = 1.0 / double(chunks);
    glm::dvec3 mean(0.0);
    for (std::size_t i = 0; i < half[0].size(); ++i) {
        const glm::dvec3 side = 0.5 * scale * (half[0][i] + half[1][i]);
        result.sides.push_back(glm::vec3(side));
        mean += side;
    }
    if (half[0].empty())
        return result;
    mean /= double(half[0].size());
    // (a - b)/2 of two independent halves spreads as their mean (a + b)/2 does about the truth.
    double sum = 0;
    for (std::size_t i = 0; i < half[0].size(); ++i) {
        const glm::dvec3 a = scale * half[0][i], b = scale * half[1][i];
        for (glm::length_t c = 0; c < 3; ++c) {
            const double denominator = std::max(0.5 * (a[c] + b[c]), 0.05 * mean[c]);
            sum += denominator > 0 ? 0.5 * std::abs(a[c] - b[c]) / denominator : 0.0;
        }
    }
    result.noise = sum / (3.0 * double(half[0].size()));
    return result;
}

void save_sums(const std::filesystem::path& path, const ReferenceSums& sums) {
    const nlohmann::json header{{"scene_hash", hexadecimal(sums.scene_hash)},
                                {"paths_per_chunk", sums.paths_per_chunk},
                                {"chunks", sums.chunks},
                                {"sides", sums.half[0].size()}};
    OutputFile file(path);
    file.write(std::string(kSumsFormat) + "\n" + header.dump() + "\n");
    for (const auto& half : sums.half)
        file.write(std::as_bytes(std::span(half)));
    file.commit();
}

std::optional<ReferenceSums> load_sums(const std::filesystem::path& path, std::uint64_t scene_hash,
                                       std::uint64_t paths_per_chunk) {
    const std::string contents = read_whole(path);
    const auto [header, data] = parse(contents, kSumsFormat);
    if (!header.is_object() || header.value("scene_hash", "") != hexadecimal(scene_hash) ||
        header.value("paths_per_chunk", std::uint64_t(0)) != paths_per_chunk)
        return std::nullopt;
    ReferenceSums sums{scene_hash, paths_per_chunk, header.value("chunks", std::uint64_t(0)), {}};
    const std::size_t count = header.value("sides", std::size_t(0)), bytes = count * sizeof(glm::dvec3);
    if (contents.size() - data != 2 * bytes)
        return std::nullopt;
    for (std::size_t h = 0; h < 2; ++h) {
        sums.half[h].resize(count);
        std::copy_n(contents.data() + data + h * bytes, bytes, reinterpret_cast<char*>(sums.half[h].data()));
    }
    return sums;
}

} // namespace kokage
