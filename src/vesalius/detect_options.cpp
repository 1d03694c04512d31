#include "vesalius/detect.h"

namespace vesalius {
namespace {

void visit_options(const std::string& prefix, RefineOptions& o, OptionVisitor& visitor) {
  visitor.option(prefix + "second-pass", o.second_pass,
                 {"", 0, 1, "Whether each person is labelled and searched again."});
  visitor.option(prefix + "max-candidates", o.max_candidates,
                 {"", 1, 1000, "Most rough skeletons refined in one frame."});
  visitor.option(prefix + "min-parts", o.min_parts, {"", 1, 200, "Fewest parts of a person after the second pass."});
  visitor.option(prefix + "min-score", o.min_score, {"", 0.0, 1.0, "Lowest score of a person."});
  visitor.option(prefix + "max-overlap", o.max_overlap,
                 {"", 0.0, 1.0, "Share of its mask that a person may have in common with a surer one."});
}

}  // namespace

void visit_options(const std::string& prefix, DetectOptions& o, OptionVisitor& visitor) {
  visit_options(prefix + "blend.", o.blend, visitor);
  visit_options(prefix + "grid.", o.grid, visitor);
  visit_options(prefix + "label.", o.label, visitor);
  visit_options(prefix + "smooth.", o.smooth, visitor);
  visit_options(prefix + "cluster.", o.cluster, visitor);
  visit_options(prefix + "search.", o.search, visitor);
  visit_options(prefix + "grow.", o.grow, visitor);
  visit_options(prefix + "refine.", o.refine, visitor);
}

}  // namespace vesalius
