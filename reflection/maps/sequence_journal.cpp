#include "reflection/maps/sequence_journal.h"
#include "common/services/error.h"
#include "common/services/random.h"

#include <functional>
#include <nlohmann/json.hpp>

namespace kokage {

namespace fs = std::filesystem;
using Json = nlohmann::json;

namespace {

std::uint64_t time_of(const fs::path& file) {
    std::error_code missing;
    const auto time = fs::last_write_time(file, missing);
    return missing ? 0 : std::uint64_t(time.time_since_epoch().count());
}
std::uint64_t bytes_of(const fs::path& file) {
    std::error_code missing;
    const std::uint64_t bytes = fs::file_size(file, missing);
    return missing ? 0 : bytes;
}

/// The facts of a finished frame; two that differ in one differ in their hash.
Json facts_of(std::uint64_t frame, const ImageFacts& image, const fs::path& output, std::uint64_t bytes) {
    return {{"frame", frame},           {"input", image.file.string()},       {"input_bytes", image.bytes},
            {"input_time", image.time}, {"file", output.filename().string()}, {"bytes", bytes}};
}

std::string line_of(const Json& json) {
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::uint64_t hash_of(const std::string& line) {
    return hash64(std::hash<std::string>{}(line));
}

} // namespace

ImageFacts facts_of_image(const fs::path& file) {
    return {file, bytes_of(file), time_of(file)};
}

SequenceJournal::SequenceJournal(const fs::path& path, const std::string& identity) : path_(path) {
    std::error_code ignored;
    const bool there = fs::exists(path, ignored) && fs::file_size(path, ignored) > 0;
    if (there)
        read(identity);
    stream_.open(path, std::ios::binary | std::ios::app);
    if (!stream_)
        throw InputError("'" + path.string() + "', the journal of the frames, can't be written");
    if (!there)
        append(line_of({{"kokage_frames", 1}, {"settings", Json::parse(identity)}}));
}

void SequenceJournal::read(const std::string& identity) {
    const std::string name = "'" + path_.string() + "' ";
    const std::string remedy = "; write to another folder, or remove that file to begin anew";
    std::ifstream stream(path_, std::ios::binary);
    std::uintmax_t whole = 0; // bytes of complete lines
    bool first = true;
    for (std::string line; std::getline(stream, line) && !stream.eof(); first = false) {
        const Json json = Json::parse(line, nullptr, false);
        if (first) {
            if (!json.is_object() || json.value("kokage_frames", Json()) != 1 || !json.contains("settings") ||
                !json["settings"].is_object())
                throw InputError(name + "is no journal of baked frames" + remedy);
            const Json asked = Json::parse(identity), &before = json["settings"];
            for (const auto& [key, value] : asked.items())
                if (before.value(key, Json()) != value)
                    throw InputError(name + "tells of frames of another " + key + " (" +
                                     before.value(key, Json()).dump() + ", not " + value.dump() + ")" + remedy);
        } else if (!json.is_object() || !json.contains("frame") || !json["frame"].is_number_unsigned()) {
            throw InputError(name + "has a line that tells of no frame: '" + line.substr(0, 60) + "'" + remedy);
        } else if (!json.contains("broken")) {
            finished_[json["frame"].get<std::uint64_t>()] = hash_of(line);
        }
        whole += line.size() + 1;
    }
    stream.close();
    if (first)
        throw InputError(name + "is no journal of baked frames" + remedy);
    fs::resize_file(path_, whole);
}

bool SequenceJournal::has(std::uint64_t frame, const ImageFacts& image, const fs::path& output,
                          const fs::path& file) const {
    const auto found = finished_.find(frame);
    const std::uint64_t bytes = found == finished_.end() ? 0 : bytes_of(file);
    return bytes > 0 && found->second == hash_of(line_of(facts_of(frame, image, output, bytes)));
}

void SequenceJournal::add_finished(std::uint64_t frame, const ImageFacts& image, const fs::path& output) {
    append(line_of(facts_of(frame, image, output, bytes_of(output))));
}

void SequenceJournal::add_broken(std::uint64_t frame, const ImageFacts& image, const std::string& why) {
    append(line_of({{"frame", frame}, {"input", image.file.string()}, {"broken", why}}));
}

void SequenceJournal::append(const std::string& line) {
    stream_ << line << "\n" << std::flush;
    if (!stream_)
        throw InputError("'" + path_.string() + "', the journal of the frames, can't be written (is the disk full?)");
}

} // namespace kokage
