#include "trees/part_names.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <vector>

namespace kokage {
namespace {

// Found anywhere in a name: compounds ("Birkenrinde", "leafsFall") hold them at any place.
constexpr std::array kFoliageWords = {
    "leaf",    "leav",     "foliage", "needle", "blossom", "petal",  "flower", "frond", "crown",  "canopy", "grass",
    "fern",    "folha",    "laub",    "blatt",  "blätt",   "blaett", "nadel",  "krone", "blüte",  "bluete", "feuille",
    "feuilla", "aiguille", "fleur",   "hoja",   "follaje", "aguja",  "fogli",  "happa", "konoha", "kareha"};
constexpr std::array kWoodWords = {"bark",   "wood",   "trunk",  "branch",  "stem",      "twig",   "root",   "log",
                                   "stump",  "rinde",  "borke",  "stamm",   "holz",      "zweig",  "wurzel", "tronc",
                                   "écorce", "ecorce", "racine", "corteza", "corteccia", "madera", "madeira"};
// Too short to be looked for inside of words.
constexpr std::array kShortFoliageWords = {"ha"};
constexpr std::array kShortWoodWords = {"ast",  "aste", "äste", "aeste", "bois", "rama", "ramas",
                                        "ramo", "rami", "miki", "eda",   "juhi", "legno"};
constexpr std::array kFoliageColors = {"green", "autumn", "fall", "herbst"};
constexpr std::array kWoodColors = {"brown"};
constexpr std::array kTreeWords = {"tree", "baum", "arbre", "arbol", "árbol", "albero", "arvore", "árvore"};
constexpr std::array kObjectWords = {"pot", "vase", "soil", "dirt", "stone", "rock", "pebble", "ground", "planter"};
// Leaves that are not there, lie on the ground, or are part of a kind's name.
constexpr std::array kNoLeaves = {"leafless",   "leaf_litter", "leaf litter", "leaf-litter", "leaflitter",
                                  "needleless", "blattlos",    "laubbaum",    "laubbäum",    "nadelbaum",
                                  "nadelbäum",  "nadelholz",   "laubholz"};

bool is_letter(char c) {
    return std::isalpha(static_cast<unsigned char>(c)) != 0 || static_cast<unsigned char>(c) >= 0x80;
}

/// A name in lower case, and where words begin in it: after what is no letter, and at capitals after small letters.
struct FoldedName {
    std::string text;
    std::vector<bool> begins;

    explicit FoldedName(const std::string& name) : text(lower_case(name)), begins(name.size() + 1, true) {
        for (std::size_t i = 1; i < name.size(); ++i) {
            const bool hump = std::isupper(static_cast<unsigned char>(name[i])) != 0 &&
                              std::islower(static_cast<unsigned char>(name[i - 1])) != 0;
            begins[i] = !is_letter(name[i]) || !is_letter(name[i - 1]) || hump;
        }
    }
};

/// Where the last of these words ends in the name; 0 = none is there.
template <std::size_t N>
std::size_t last_end(const FoldedName& name, const std::array<const char*, N>& words, bool whole_words) {
    std::size_t last = 0;
    for (const std::string word : words)
        for (std::size_t at = name.text.find(word); at != std::string::npos; at = name.text.find(word, at + 1))
            if (!whole_words || (name.begins[at] && name.begins[at + word.size()]))
                last = std::max(last, at + word.size());
    return last;
}

template <std::size_t N>
bool holds_any(const std::string& name, const std::array<const char*, N>& words) {
    return last_end(FoldedName(name), words, false) > 0;
}

/// Overwritten by '_', so that places stay.
void strike_out_no_leaves(std::string& text) {
    for (const std::string word : kNoLeaves)
        for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at))
            text.replace(at, word.size(), word.size(), '_');
}

} // namespace

std::string lower_case(const std::string& text) {
    std::string result = text;
    std::transform(result.begin(), result.end(), result.begin(), [](unsigned char c) { return char(std::tolower(c)); });
    // UTF-8: U+00C0 to U+00DE (but for the sign of multiplication) are the capitals of U+00E0 to U+00FE.
    for (std::size_t i = 0; i + 1 < result.size(); ++i) {
        const auto second = static_cast<unsigned char>(result[i + 1]);
        if (static_cast<unsigned char>(result[i]) == 0xC3 && second >= 0x80 && second <= 0x9E && second != 0x97)
            result[i + 1] = char(second + 0x20);
    }
    return result;
}

NameSense sense_of_name(const std::string& name) {
    FoldedName folded(name);
    strike_out_no_leaves(folded.text);
    std::size_t foliage = std::max(last_end(folded, kFoliageWords, false), last_end(folded, kShortFoliageWords, true));
    std::size_t wood = std::max(last_end(folded, kWoodWords, false), last_end(folded, kShortWoodWords, true));
    if (foliage == 0 && wood == 0) {
        wood = last_end(folded, kWoodColors, false);
        foliage = wood > 0 ? 0 : last_end(folded, kFoliageColors, false);
    }
    NameSense sense{.foliage = foliage > 0, .wood = wood > 0, .kind = {}};
    if (foliage != wood)
        sense.kind = foliage > wood ? TreePartKind::foliage : TreePartKind::bark;
    return sense;
}

bool names_foliage(const std::string& name) {
    return sense_of_name(name).kind == TreePartKind::foliage;
}
bool names_wood(const std::string& name) {
    return sense_of_name(name).wood;
}
bool names_tree(const std::string& name) {
    return holds_any(name, kTreeWords);
}
bool names_object(const std::string& name) {
    const NameSense sense = sense_of_name(name);
    return holds_any(name, kObjectWords) && !sense.wood && !sense.foliage;
}

} // namespace kokage
