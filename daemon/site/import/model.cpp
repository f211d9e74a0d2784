#include "daemon/site/import/model.h"

namespace rayloc {

Bounds bounds_of(const Model& model) {
  Bounds bounds;
  for (const ModelPart& part : model.parts) {
    const Bounds own = bounds_of(part.mesh);
    bounds.include(own.lower);
    bounds.include(own.upper);
  }
  return bounds;
}

}  // namespace rayloc
