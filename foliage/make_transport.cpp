#include "common/services/error.h"
#include "foliage/bundles/bundles.h"
#include "foliage/light_maps.h"
#include "foliage/method.h"
#include "foliage/paper.h"
#include "foliage/path_traced.h"

namespace kokage {

std::unique_ptr<Transport> make_transport(const PatchScene& scene, const Tree& tree, const ShadingOptions& options,
                                          Progress& progress) {
    validate(scene);
    switch (options.method) {
    case Method::paper:
        return make_paper_transport(scene, tree, options, progress);
    case Method::light_maps:
        return make_light_maps_transport(scene, tree, options, progress);
    case Method::bundles:
        return make_bundles_transport(scene, tree, options, progress);
    case Method::path_traced:
        return make_path_traced_transport(scene, tree, options, progress);
    }
    throw InputError("this build has no method of that number");
}

} // namespace kokage
