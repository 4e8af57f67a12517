#include "foliage/method.h"
#include "common/services/error.h"

#include <string>

namespace kokage {

Method method_from_name(std::string_view name) {
    for (Method method : {Method::paper, Method::light_maps, Method::bundles, Method::path_traced})
        if (name == method_name(method))
            return method;
    throw InputError("no method is called '" + std::string(name) +
                     "'; methods are paper, light-maps, bundles, path-traced");
}

std::string_view method_name(Method method) {
    switch (method) {
    case Method::paper:
        return "paper";
    case Method::light_maps:
        return "light-maps";
    case Method::bundles:
        return "bundles";
    case Method::path_traced:
        return "path-traced";
    }
    return "";
}

} // namespace kokage
