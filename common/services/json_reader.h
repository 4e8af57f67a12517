#pragma once
// JSON files that people write: read strictly, every complaint one line with the file, the place as a JSON pointer
// (RFC 6901), what was found and what is allowed.
#include "common/types.h"

#include <cstddef>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace kokage {

/// Comments are allowed; a key that stands twice is refused. `file` names the text in messages, `mend` ends those about
/// its syntax ("; see ..."). Throws InputError.
nlohmann::ordered_json parse_json(std::string_view text, const std::string& file, const std::string& mend = "");

/// A value of such a file and its place. The parsed file must outlive it.
class JsonReader {
  public:
    JsonReader(const nlohmann::ordered_json& value, std::string file, std::string pointer = "")
        : value_(&value), file_(std::move(file)), pointer_(std::move(pointer)) {}

    /// "FILE: /trees/2/leaves: WHAT".
    [[noreturn]] void fail(const std::string& what) const;
    /// The value, or what kind of value it is, for such a message.
    std::string found() const;

    bool is_object() const;
    bool is_array() const;
    bool is_string() const;
    bool is_number() const;
    bool is_boolean() const;

    /// Refuses anything but an object with some of these keys, and tells the nearest one.
    void check_keys(std::initializer_list<const char*> known) const;
    /// A member of an object, or nothing.
    std::optional<JsonReader> find(const char* key) const;
    /// A member that must be there.
    JsonReader at(const char* key) const;
    /// Members of an object, in the file's order.
    void for_each_member(const std::function<void(const std::string& key, const JsonReader& value)>& take) const;
    /// Elements of an array; `least` to `most` of them.
    std::vector<JsonReader> elements(std::size_t least, std::size_t most) const;

    /// Finite and within [low, high].
    double number(double low, double high) const;
    int integer(int low, int high) const;
    bool boolean() const;
    /// One line, not empty.
    std::string text() const;
    /// One of these words; its index.
    std::size_t choice(std::initializer_list<const char*> words) const;
    /// Three numbers within [low, high].
    glm::dvec3 vector(double low, double high) const;
    /// One number for all channels, or three.
    glm::vec3 color(double high = 1) const;

    const std::string& pointer() const { return pointer_; }

  private:
    JsonReader inner(const nlohmann::ordered_json& value, const std::string& token) const;

    const nlohmann::ordered_json* value_;
    std::string file_, pointer_;
};

} // namespace kokage
