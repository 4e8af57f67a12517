#include "common/services/error.h"
#include "common/services/named_file.h"
#include "reflection/maps/cube_file.h"
#include "reflection/maps/ktx2_layout.h"

#include <algorithm>
#include <map>
#include <stdexcept>

namespace kokage {
namespace {

using Bytes = std::span<const unsigned char>;
constexpr std::uint64_t kMostKtx2Bytes = std::uint64_t(1) << 34;
constexpr std::uint64_t kLargestSize = 16384;

/// Reads one file; every number is checked before it leads anywhere.
class Ktx2Reader {
  public:
    Ktx2Reader(std::string name, Bytes bytes) : name_(std::move(name)), bytes_(bytes) {}

    CubeFile read() {
        read_header();
        read_descriptor();
        read_key_values();
        check_level_index();
        CubeFile file;
        file.format = format_.format;
        file.cube = assumed_cube(int(size_), int(levels_));
        describe_lobes(file);
        for (std::size_t i = 0; i < levels_; ++i)
            decode_texels(bytes_.data() + offsets_[i], format_.format, file.cube.levels[i].texels);
        check_finite(file.cube, name_);
        return file;
    }

  private:
    [[noreturn]] void fail(const std::string& why) const { throw InputError(name_ + ": " + why); }
    std::uint64_t u32(std::size_t at) const { return little_endian(bytes_, at, 4); }
    std::uint64_t u64(std::size_t at) const { return little_endian(bytes_, at, 8); }

    void read_header() {
        const auto& id = ktx2::kIdentifier;
        if (bytes_.size() >= id.size() && std::equal(id.begin(), id.begin() + 5, bytes_.begin()) &&
            !std::equal(id.begin(), id.end(), bytes_.begin()))
            fail("it is a KTX file of another version than 2.0 (or damaged); convert it to KTX 2.0");
        if (bytes_.size() < id.size() || !std::equal(id.begin(), id.end(), bytes_.begin()))
            fail("it is not a KTX 2.0 file");
        if (bytes_.size() < ktx2::kHeaderBytes)
            fail("it is cut off within its header");
        const std::uint64_t vk_format = u32(12);
        const auto known = std::find_if(ktx2::kFormats.begin(), ktx2::kFormats.end(),
                                        [&](const ktx2::Format& f) { return f.vk_format == vk_format; });
        if (u32(44) != 0)
            fail("it is supercompressed (scheme " + std::to_string(u32(44)) + "), which is not read; write it without");
        if (known == ktx2::kFormats.end())
            fail("its texels have VkFormat " + std::to_string(vk_format) +
                 "; 97 (half floats), 109 (floats) and 123 (shared exponent) can be read");
        format_ = *known;
        if (u32(16) != format_.type_size)
            fail("its type size is " + std::to_string(u32(16)) + ", not its format's " +
                 std::to_string(format_.type_size));
        size_ = u32(20);
        if (u32(36) != 6)
            fail("it has " + std::to_string(u32(36)) + " face(s); a cube map has 6");
        if (u32(32) != 0)
            fail("it is an array of " + std::to_string(u32(32)) + " cube maps; give a single one");
        if (size_ < 1 || size_ > kLargestSize || u32(24) != size_ || u32(28) != 0)
            fail("its faces are " + std::to_string(size_) + " x " + std::to_string(u32(24)) + " x " +
                 std::to_string(u32(28)) + " texels; a cube's are square, flat and at most " +
                 std::to_string(kLargestSize) + " wide");
        levels_ = std::max<std::uint64_t>(u32(40), 1); // 0 asks the reader to make the smaller levels
        if (levels_ > 15 || size_ >> (levels_ - 1) == 0)
            fail("it has " + std::to_string(levels_) + " levels, more than faces of " + std::to_string(size_) +
                 " texels can");
        if (bytes_.size() < ktx2::kHeaderBytes + ktx2::kLevelBytes * levels_)
            fail("it is cut off within its level index");
    }

    /// A part of the file that the index names.
    Bytes part(const char* what, std::uint64_t at, std::uint64_t length) const {
        if (at > bytes_.size() || length > bytes_.size() - at)
            fail(std::string("its ") + what + " at byte " + std::to_string(at) + " with " + std::to_string(length) +
                 " bytes lies outside of its " + std::to_string(bytes_.size()) + " bytes; it is cut off or damaged");
        return bytes_.subspan(std::size_t(at), std::size_t(length));
    }

    void read_descriptor() const {
        const std::size_t end_of_index = ktx2::kHeaderBytes + ktx2::kLevelBytes * std::size_t(levels_);
        if (u32(48) != end_of_index)
            fail("its data format descriptor is said to begin at byte " + std::to_string(u32(48)) + ", not at " +
                 std::to_string(end_of_index) + "; it is damaged");
        const Bytes descriptor = part("data format descriptor", u32(48), u32(52));
        const std::vector<unsigned char> ours = ktx2::data_format_descriptor(format_.format);
        if (descriptor.size() < 28 || little_endian(descriptor, 0, 4) != descriptor.size())
            fail("its data format descriptor does not have the length that it says; it is damaged");
        if (descriptor[13] > 1) // 0: unspecified
            fail("its colours have other primaries than BT.709 (" + std::to_string(descriptor[13]) +
                 "); convert them first");
        if (descriptor[14] != 1)
            fail("its texels are not linear radiance (transfer function " + std::to_string(descriptor[14]) +
                 "); convert them first");
        // The rest of it follows from the format: the model, the sizes, and what each sample is.
        const bool same = descriptor.size() == ours.size() && descriptor[12] == ours[12] &&
                          std::equal(ours.begin() + 16, ours.begin() + 28, descriptor.begin() + 16);
        bool same_samples = same;
        for (std::size_t i = 28; same && i < ours.size(); i += 16) // bits and channels; ranges vary among writers
            same_samples &= std::equal(ours.begin() + std::ptrdiff_t(i), ours.begin() + std::ptrdiff_t(i) + 8,
                                       descriptor.begin() + std::ptrdiff_t(i));
        if (!same_samples)
            fail("its data format descriptor contradicts its VkFormat " + std::to_string(format_.vk_format) +
                 "; it is damaged, or its writer was wrong");
    }

    void read_key_values() {
        if (u64(64) != 0 || u64(72) != 0)
            fail("it has data for supercompression, though it is not supercompressed; it is damaged");
        if (u32(60) == 0)
            return;
        const Bytes data = part("key/value data", u32(56), u32(60));
        for (std::size_t at = 0; at < data.size();) {
            const std::uint64_t length = data.size() - at >= 4 ? little_endian(data, at, 4) : 0;
            if (length < 2 || length > data.size() - at - 4)
                fail("its key/value data is damaged at byte " + std::to_string(u32(56) + at));
            const auto pair = data.subspan(at + 4, std::size_t(length));
            const auto nul = std::find(pair.begin(), pair.end(), static_cast<unsigned char>(0));
            if (nul == pair.end() || nul == pair.begin())
                fail("its key/value data has an entry without a key at byte " + std::to_string(u32(56) + at));
            std::string value(nul + 1, pair.end());
            while (!value.empty() && value.back() == '\0')
                value.pop_back();
            if (!key_values_.emplace(std::string(pair.begin(), nul), value).second)
                fail("its key/value data has a key twice; it is damaged");
            at += 4 + (std::size_t(length) + 3) / 4 * 4;
        }
        const auto orientation = key_values_.find("KTXorientation");
        if (orientation != key_values_.end() && orientation->second != "rd")
            fail("its KTXorientation is '" + without_controls(orientation->second).substr(0, 20) +
                 "'; a cube map's rows go right and down (\"rd\")");
    }

    void check_level_index() {
        const std::size_t alignment = ktx2::level_alignment(format_.format);
        const auto aligned = [&](std::uint64_t at) { return (at + alignment - 1) / alignment * alignment; };
        std::uint64_t expected = u32(60) != 0 ? u32(56) + u32(60) : u32(48) + u32(52);
        offsets_.resize(std::size_t(levels_));
        for (std::size_t i = std::size_t(levels_); i-- > 0;) {
            const std::size_t at = ktx2::kHeaderBytes + ktx2::kLevelBytes * i;
            const std::uint64_t offset = u64(at), length = u64(at + 8), uncompressed = u64(at + 16);
            const std::uint64_t size = size_ >> i, wanted = 6 * size * size * file_texel_bytes(format_.format);
            const std::string which = "level " + std::to_string(i) + " of " + std::to_string(levels_);
            if (length != wanted || uncompressed != wanted)
                fail(which + " is said to have " + std::to_string(length) + " bytes (" + std::to_string(uncompressed) +
                     " before compression); six faces of " + std::to_string(size) + " x " + std::to_string(size) +
                     " texels have " + std::to_string(wanted));
            part(which.c_str(), offset, length);
            if (offset != aligned(expected))
                fail(which + " is said to begin at byte " + std::to_string(offset) + ", not at " +
                     std::to_string(aligned(expected)) + "; it is damaged");
            offsets_[i] = std::size_t(offset);
            expected = offset + length;
        }
        if (expected != bytes_.size())
            fail("it has " + std::to_string(bytes_.size() - expected) + " bytes after its last level; it is damaged");
    }

    std::string value_of(const char* key) const {
        const auto found = key_values_.find(key);
        return found == key_values_.end() ? std::string() : found->second;
    }

    void describe_lobes(CubeFile& file) const {
        const std::string lobe = value_of("kokage.lobe"), parameters = value_of("kokage.parameters");
        file.writer = without_controls(value_of("KTXwriter")).substr(0, 100);
        file.lobes_known = key_values_.contains("kokage.lobe") || key_values_.contains("kokage.parameters");
        if (file.lobes_known)
            read_lobes(lobe, parameters, file.cube);
        if (key_values_.contains("kokage.checksum") &&
            value_of("kokage.checksum") != ktx2::checksum_text(lobe, parameters, bytes_.subspan(offsets_.back())))
            fail("its texels or notes are not those that were written (kokage.checksum differs); it is damaged, or "
                 "another program changed it and kept that key");
    }

    void read_lobes(const std::string& lobe, const std::string& parameters, PrefilteredCube& cube) const {
        try {
            cube.kind = lobe_kind_from_name(lobe);
            std::size_t at = 0;
            for (PrefilteredCube::Level& level : cube.levels) {
                const std::size_t end = std::min(parameters.find(' ', at), parameters.size());
                if (at > parameters.size())
                    throw std::invalid_argument("");
                set_parameter(level, cube.kind, std::string_view(parameters).substr(at, end - at));
                at = end + 1;
            }
            if (at <= parameters.size())
                throw std::invalid_argument("");
        } catch (const std::exception&) {
            fail("its notes on the levels' lobes (kokage.lobe, kokage.parameters) do not fit its " +
                 std::to_string(levels_) + " levels; they are damaged");
        }
    }

    std::string name_;
    Bytes bytes_;
    ktx2::Format format_{};
    std::uint64_t size_ = 0, levels_ = 0;
    std::vector<std::size_t> offsets_;
    std::map<std::string, std::string> key_values_;
};

} // namespace

CubeFile read_ktx2(const std::filesystem::path& path) {
    return read_ktx2(read_file_bytes(path, kMostKtx2Bytes), path.string());
}

CubeFile read_ktx2(std::span<const unsigned char> bytes, const std::string& name) {
    return Ktx2Reader(name, bytes).read();
}

} // namespace kokage
