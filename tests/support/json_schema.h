#pragma once
// Whether JSON obeys a JSON Schema: the part of draft-07 that our schemas use. A keyword that is not known here is an
// error, so that nothing in a schema goes unheeded.
#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <stdexcept>
#include <string>

namespace kokage {

class JsonSchema {
  public:
    explicit JsonSchema(nlohmann::json root) : root_(std::move(root)) {}

    bool accepts(const nlohmann::json& value) const { return accepts(root_, value); }
    const nlohmann::json& root() const { return root_; }

  private:
    using Json = nlohmann::json;

    bool accepts(const Json& schema, const Json& value) const {
        for (const auto& [keyword, rule] : schema.items())
            if (!obeys(keyword, rule, schema, value))
                return false;
        return true;
    }

    bool obeys(const std::string& keyword, const Json& rule, const Json& schema, const Json& value) const {
        static const std::set<std::string> says_nothing = {"$schema", "title",    "description",
                                                           "default", "examples", "definitions"};
        if (says_nothing.contains(keyword))
            return true;
        if (keyword == "$ref")
            return accepts(root_.at(Json::json_pointer(rule.get<std::string>().substr(1))), value);
        if (keyword == "type")
            return is_of_type(rule.get<std::string>(), value);
        if (keyword == "const")
            return value == rule;
        if (keyword == "enum")
            return std::find(rule.begin(), rule.end(), value) != rule.end();
        if (keyword == "not")
            return !accepts(rule, value);
        if (keyword == "allOf" || keyword == "anyOf" || keyword == "oneOf")
            return obeys_some(keyword, rule, value);
        if (value.is_object())
            return object_obeys(keyword, rule, schema, value);
        if (value.is_array())
            return array_obeys(keyword, rule, value);
        if (value.is_string())
            return text_obeys(keyword, rule, value.get<std::string>());
        if (value.is_number() && keyword == "minimum")
            return value.get<double>() >= rule.get<double>();
        if (value.is_number() && keyword == "maximum")
            return value.get<double>() <= rule.get<double>();
        return is_known(keyword);
    }

    static bool is_of_type(const std::string& type, const Json& value) {
        if (type == "integer")
            return value.is_number() && value.get<double>() == std::floor(value.get<double>());
        return type == "object"    ? value.is_object()
               : type == "array"   ? value.is_array()
               : type == "string"  ? value.is_string()
               : type == "number"  ? value.is_number()
               : type == "boolean" ? value.is_boolean()
                                   : throw std::runtime_error("type " + type);
    }

    bool obeys_some(const std::string& keyword, const Json& schemas, const Json& value) const {
        std::size_t count = 0;
        for (const Json& one : schemas)
            count += accepts(one, value);
        return keyword == "allOf" ? count == schemas.size() : keyword == "anyOf" ? count > 0 : count == 1;
    }

    bool object_obeys(const std::string& keyword, const Json& rule, const Json& schema, const Json& value) const {
        for (const auto& [key, member] : value.items()) {
            if (keyword == "properties" && rule.contains(key) && !accepts(rule[key], member))
                return false;
            if (keyword == "propertyNames" && !accepts(rule, Json(key)))
                return false;
            const bool known = schema.contains("properties") && schema["properties"].contains(key);
            if (keyword == "additionalProperties" && !known && (rule == Json(false) || !accepts(rule, member)))
                return false;
            if (keyword == "dependencies" && rule.contains(key) &&
                !(rule[key].is_array() ? has_all(value, rule[key]) : accepts(rule[key], value)))
                return false;
        }
        return keyword == "required" ? has_all(value, rule) : is_known(keyword);
    }

    static bool has_all(const Json& value, const Json& keys) {
        for (const Json& key : keys)
            if (!value.contains(key.get<std::string>()))
                return false;
        return true;
    }

    bool array_obeys(const std::string& keyword, const Json& rule, const Json& value) const {
        if (keyword == "minItems")
            return value.size() >= rule.get<std::size_t>();
        if (keyword == "maxItems")
            return value.size() <= rule.get<std::size_t>();
        if (keyword == "items")
            for (std::size_t i = 0; i < value.size(); ++i)
                if (!rule.is_array() ? !accepts(rule, value[i]) : i < rule.size() && !accepts(rule[i], value[i]))
                    return false;
        return is_known(keyword);
    }

    static bool text_obeys(const std::string& keyword, const Json& rule, const std::string& text) {
        if (keyword == "minLength")
            return text.size() >= rule.get<std::size_t>();
        if (keyword == "maxLength")
            return text.size() <= rule.get<std::size_t>();
        if (keyword == "pattern")
            return std::regex_search(text, compiled(rule.get<std::string>()));
        return is_known(keyword);
    }

    static const std::regex& compiled(const std::string& pattern) {
        static std::map<std::string, std::regex> known;
        const auto at = known.find(pattern);
        return at != known.end() ? at->second : known.emplace(pattern, std::regex(pattern)).first->second;
    }

    static bool is_known(const std::string& keyword) {
        static const std::set<std::string> known = {"properties",    "required",     "additionalProperties",
                                                    "propertyNames", "dependencies", "items",
                                                    "minItems",      "maxItems",     "minimum",
                                                    "maximum",       "minLength",    "maxLength",
                                                    "pattern"};
        if (!known.contains(keyword))
            throw std::runtime_error("the schema's keyword '" + keyword + "' is not known to this test");
        return true;
    }

    Json root_;
};

} // namespace kokage
