#include "common/services/json_reader.h"
#include "common/services/error.h"
#include "common/services/named_file.h"
#include "common/services/nearest_word.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

namespace kokage {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kLongestText = 2000;

/// nlohmann says where as "parse error at line 3, column 5: ...", with more before and after.
std::string syntax_complaint(const std::string& what) {
    const std::size_t at = what.find("line "), colon = what.find(": ", at == std::string::npos ? 0 : at);
    if (at == std::string::npos || colon == std::string::npos)
        return "not JSON";
    std::string rest = what.substr(colon + 2);
    rest.erase(std::remove_if(rest.begin(), rest.end(), [](unsigned char c) { return c < 32; }), rest.end());
    return what.substr(at, colon - at) + ": not JSON (" + rest.substr(0, 160) + ")";
}

std::string without_quotes(std::string text) {
    std::erase(text, '\'');
    return text;
}

/// A token of a JSON pointer.
std::string escaped(const std::string& key) {
    std::string token;
    for (const char c : shown_name(key))
        token += c == '~' ? "~0" : c == '/' ? "~1" : std::string(1, c);
    return token;
}

std::string shown_number(double value) {
    return Json(value == std::floor(value) && std::abs(value) < 1e15 ? Json((long long)(value)) : Json(value)).dump();
}

std::string range_text(double low, double high) {
    return shown_number(low) + " to " + shown_number(high);
}

/// An object or array that the parser is in.
struct OpenValue {
    bool is_array = false;
    std::size_t elements = 0;        ///< of an array, so far
    std::string key = {};            ///< of the member or element that the parser is at
    std::set<std::string> keys = {}; ///< of an object, so far
};

std::string pointer_to(const std::vector<OpenValue>& open) {
    std::string pointer;
    for (const OpenValue& value : open)
        pointer += "/" + escaped(value.key);
    return pointer;
}

} // namespace

Json parse_json(std::string_view text, const std::string& file, const std::string& mend) {
    std::vector<OpenValue> open;
    const auto watch = [&](int, Json::parse_event_t event, Json& parsed) {
        using Event = Json::parse_event_t;
        if (event == Event::key) {
            open.back().key = parsed.get<std::string>();
            if (!open.back().keys.insert(open.back().key).second)
                throw InputError(file + ": " + pointer_to(open) + ": '" + shown_name(open.back().key) +
                                 "' stands there twice; take one away");
        } else if (event == Event::object_end || event == Event::array_end) {
            open.pop_back();
        } else {
            if (!open.empty() && open.back().is_array)
                open.back().key = std::to_string(open.back().elements++);
            if (event != Event::value)
                open.push_back({.is_array = event == Event::array_start});
        }
        return true;
    };
    try {
        return Json::parse(text, watch, true, true);
    } catch (const Json::parse_error& error) {
        throw InputError(file + ": " + syntax_complaint(error.what()) + mend);
    } catch (const Json::out_of_range& error) { // a number, whose event has not come
        if (!open.empty() && open.back().is_array)
            open.back().key = std::to_string(open.back().elements);
        const std::string what = error.what(), pointer = pointer_to(open);
        const std::size_t quote = what.find('\'');
        throw InputError(file + ": " + (pointer.empty() ? "" : pointer + ": ") + "found " +
                         (quote == std::string::npos ? "a number" : shown_name(without_quotes(what.substr(quote)))) +
                         ", which is too large; numbers reach to 1.7e308" + mend);
    }
}

void JsonReader::fail(const std::string& what) const {
    throw InputError(file_ + ": " + (pointer_.empty() ? "" : pointer_ + ": ") + what);
}

JsonReader JsonReader::inner(const Json& value, const std::string& token) const {
    return {value, file_, pointer_ + "/" + escaped(token)};
}

bool JsonReader::is_object() const {
    return value_->is_object();
}

bool JsonReader::is_array() const {
    return value_->is_array();
}

bool JsonReader::is_string() const {
    return value_->is_string();
}

bool JsonReader::is_number() const {
    return value_->is_number();
}

bool JsonReader::is_boolean() const {
    return value_->is_boolean();
}

std::string JsonReader::found() const {
    if (value_->is_object())
        return "an object { }";
    if (value_->is_array())
        return "a list of " + std::to_string(value_->size());
    std::string text = value_->dump(-1, ' ', false, Json::error_handler_t::replace);
    return shown_name(text);
}

void JsonReader::check_keys(std::initializer_list<const char*> known) const {
    const std::vector<std::string> words(known.begin(), known.end());
    std::string list;
    for (const std::string& word : words)
        list += (list.empty() ? "" : ", ") + word;
    if (!is_object())
        fail("found " + found() + " where an object { } is needed, with: " + list);
    for (const auto& [key, value] : value_->items()) {
        if (std::find(words.begin(), words.end(), key) != words.end())
            continue;
        const std::optional<std::string> near = nearest_word(key, words);
        inner(value, key)
            .fail("nothing is called '" + shown_name(key) + "' here; " +
                  (near ? "did you mean '" + *near + "'? There are: " : "there are: ") + list);
    }
}

std::optional<JsonReader> JsonReader::find(const char* key) const {
    const auto at = value_->is_object() ? value_->find(key) : value_->end();
    return value_->is_object() && at != value_->end() ? std::optional(inner(*at, key)) : std::nullopt;
}

JsonReader JsonReader::at(const char* key) const {
    if (const std::optional<JsonReader> member = find(key))
        return *member;
    fail("'" + std::string(key) + "' is missing");
}

void JsonReader::for_each_member(
    const std::function<void(const std::string& key, const JsonReader& value)>& take) const {
    if (!is_object())
        fail("found " + found() + " where an object { } is needed");
    for (const auto& [key, value] : value_->items())
        take(key, inner(value, key));
}

std::vector<JsonReader> JsonReader::elements(std::size_t least, std::size_t most) const {
    const std::string allowed =
        least == most ? std::to_string(least) : std::to_string(least) + " to " + std::to_string(most);
    if (!is_array() || value_->size() < least || value_->size() > most)
        fail("found " + found() + " where a list [ ] of " + allowed + " is needed");
    std::vector<JsonReader> all;
    for (std::size_t k = 0; k < value_->size(); ++k)
        all.push_back(inner((*value_)[k], std::to_string(k)));
    return all;
}

double JsonReader::number(double low, double high) const {
    const double value = is_number() ? value_->get<double>() : NAN;
    if (!(value >= low && value <= high))
        fail("found " + found() + " where a number from " + range_text(low, high) + " is needed");
    return value;
}

int JsonReader::integer(int low, int high) const {
    const double value = is_number() ? value_->get<double>() : NAN;
    if (!(value >= low && value <= high && value == std::floor(value)))
        fail("found " + found() + " where a whole number from " + range_text(low, high) + " is needed");
    return int(value);
}

bool JsonReader::boolean() const {
    if (!is_boolean())
        fail("found " + found() + " where true or false is needed");
    return value_->get<bool>();
}

std::string JsonReader::text() const {
    if (!is_string())
        fail("found " + found() + " where text in quotes is needed");
    const auto& text = value_->get_ref<const std::string&>();
    if (text.empty() || text.size() > kLongestText ||
        std::any_of(text.begin(), text.end(), [](unsigned char c) { return c < 32 || c == 127; }))
        fail("found " + found() + " where one line of text of at most " + std::to_string(kLongestText) +
             " letters is needed");
    return text;
}

std::size_t JsonReader::choice(std::initializer_list<const char*> words) const {
    std::string list;
    std::size_t index = 0;
    for (const char* word : words) {
        if (is_string() && value_->get_ref<const std::string&>() == word)
            return index;
        list += (list.empty() ? "" : ", ") + std::string(word);
        ++index;
    }
    fail("found " + found() + " where one of these is needed: " + list);
}

glm::dvec3 JsonReader::vector(double low, double high) const {
    const std::vector<JsonReader> parts = elements(3, 3);
    return {parts[0].number(low, high), parts[1].number(low, high), parts[2].number(low, high)};
}

glm::vec3 JsonReader::color(double high) const {
    if (is_number())
        return glm::vec3(float(number(0, high)));
    if (!is_array())
        fail("found " + found() + " where a number (a grey) or a list [ ] of 3, each from " + range_text(0, high) +
             ", is needed");
    return vector(0, high);
}

} // namespace kokage
