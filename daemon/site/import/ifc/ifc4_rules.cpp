#include "daemon/site/import/ifc/ifc4_rules.h"

#include <algorithm>
#include <array>

#include "daemon/site/import/ifc/row_of.h"

namespace rayloc {
namespace {

// Shapes that assimp 5.2.5 reads. A type without a row is left out and counted.
constexpr std::array kRules = {
    Ifc4Rule{"IFCCARTESIANPOINT", 'P', "~.", ""},
    Ifc4Rule{"IFCDIRECTION", 'D', "~.", ""},
    Ifc4Rule{"IFCVECTOR", 'V', "#D%.", ""},
    Ifc4Rule{"IFCAXIS1PLACEMENT", 'X', "#P?D", ""},
    Ifc4Rule{"IFCAXIS2PLACEMENT2D", 'B', "#P?D", ""},
    Ifc4Rule{"IFCAXIS2PLACEMENT3D", 'A', "#P?D?D", ""},
    Ifc4Rule{"IFCLOCALPLACEMENT", 'N', "?N&A", ""},
    Ifc4Rule{"IFCCARTESIANTRANSFORMATIONOPERATOR3D", 'T', "?D?D#P=.?D", ""},
    Ifc4Rule{"IFCCARTESIANTRANSFORMATIONOPERATOR3DNONUNIFORM", 'T', "?D?D#P=.?D=.=.", ""},
    Ifc4Rule{"IFCLINE", 'C', "#P#V", ""},
    Ifc4Rule{"IFCCIRCLE", 'C', "#Z%.", ""},
    Ifc4Rule{"IFCELLIPSE", 'C', "#Z%.%.", ""},
    Ifc4Rule{"IFCPOLYLINE", 'C', "@P", ""},
    Ifc4Rule{"IFCTRIMMEDCURVE", 'C', "#C|.|.^.^.", ""},
    Ifc4Rule{"IFCCOMPOSITECURVE", 'C', "@G^.", ""},
    Ifc4Rule{"IFCCOMPOSITECURVESEGMENT", 'G', "^.^.#C", ""},
    Ifc4Rule{"IFCARBITRARYCLOSEDPROFILEDEF", 'F', "^.=.#C", ""},
    Ifc4Rule{"IFCARBITRARYPROFILEDEFWITHVOIDS", 'F', "^.=.#C@C", ""},
    Ifc4Rule{"IFCARBITRARYOPENPROFILEDEF", 'F', "^.=.#C", ""},
    Ifc4Rule{"IFCRECTANGLEPROFILEDEF", 'F', "^.=.&B%.%.", ""},
    Ifc4Rule{"IFCROUNDEDRECTANGLEPROFILEDEF", 'F', "^.=.&B%.%.%.", ""},
    Ifc4Rule{"IFCRECTANGLEHOLLOWPROFILEDEF", 'F', "^.=.&B%.%.%.=.=.", ""},
    Ifc4Rule{"IFCCIRCLEPROFILEDEF", 'F', "^.=.&B%.", ""},
    Ifc4Rule{"IFCCIRCLEHOLLOWPROFILEDEF", 'F', "^.=.&B%.%.", ""},
    Ifc4Rule{"IFCEXTRUDEDAREASOLID", 'I', "#F&A#D%.", ""},
    Ifc4Rule{"IFCREVOLVEDAREASOLID", 'I', "#F&A#X%.", ""},
    Ifc4Rule{"IFCFACETEDBREP", 'I', "#S", ""},
    Ifc4Rule{"IFCFACETEDBREPWITHVOIDS", 'I', "#S@S", ""},
    Ifc4Rule{"IFCFACEBASEDSURFACEMODEL", 'I', "@S", ""},
    Ifc4Rule{"IFCSHELLBASEDSURFACEMODEL", 'I', "@S", ""},
    Ifc4Rule{"IFCMAPPEDITEM", 'I', "#M#T", ""},
    Ifc4Rule{"IFCHALFSPACESOLID", 'H', "#U^.", ""},
    Ifc4Rule{"IFCBOXEDHALFSPACE", 'H', "#U^.", "IFCHALFSPACESOLID"},  // the box has no effect
    Ifc4Rule{"IFCPOLYGONALBOUNDEDHALFSPACE", 'H', "#U^.&A#C", ""},
    Ifc4Rule{"IFCPLANE", 'U', "&A", ""},
    Ifc4Rule{"IFCCONNECTEDFACESET", 'S', "@E", ""},
    Ifc4Rule{"IFCCLOSEDSHELL", 'S', "@E", ""},
    Ifc4Rule{"IFCOPENSHELL", 'S', "@E", ""},
    Ifc4Rule{"IFCFACE", 'E', "@O", ""},
    Ifc4Rule{"IFCFACEBOUND", 'O', "#L^.", ""},
    Ifc4Rule{"IFCFACEOUTERBOUND", 'O', "#L^.", ""},
    Ifc4Rule{"IFCPOLYLOOP", 'L', "@P", ""},
    Ifc4Rule{"IFCREPRESENTATIONMAP", 'M', "&A#R", ""},
};

constexpr std::string_view kFurniture = "IFCFURNISHINGELEMENT";

constexpr std::array kProducts = {
    // The structure of the building. Its kind is ".ELEMENT." where IFC 4 states none.
    Ifc4Product{"IFCSITE", "", ",.ELEMENT.,$,$,$,$,$"},
    Ifc4Product{"IFCBUILDING", "", ",.ELEMENT.,$,$,$"},
    Ifc4Product{"IFCFACILITY", "IFCBUILDING", ",.ELEMENT.,$,$,$"},
    Ifc4Product{"IFCBUILDINGSTOREY", "", ",.ELEMENT.,0."},
    Ifc4Product{"IFCFACILITYPART", "IFCBUILDINGSTOREY", ",.ELEMENT.,0."},
    Ifc4Product{"IFCFACILITYPARTCOMMON", "IFCBUILDINGSTOREY", ",.ELEMENT.,0."},
    Ifc4Product{"IFCSPACE", "", ",.ELEMENT.,.INTERNAL.,$"},
    Ifc4Product{"IFCWALL", "", ""},
    Ifc4Product{"IFCWALLSTANDARDCASE", "", ""},
    Ifc4Product{"IFCWALLELEMENTEDCASE", "IFCWALL", ""},
    Ifc4Product{"IFCSLAB", "", ",$"},
    Ifc4Product{"IFCSLABSTANDARDCASE", "IFCSLAB", ",$"},
    Ifc4Product{"IFCSLABELEMENTEDCASE", "IFCSLAB", ",$"},
    Ifc4Product{"IFCDOOR", "", ",$,$"},
    Ifc4Product{"IFCDOORSTANDARDCASE", "IFCDOOR", ",$,$"},
    Ifc4Product{"IFCWINDOW", "", ",$,$"},
    Ifc4Product{"IFCWINDOWSTANDARDCASE", "IFCWINDOW", ",$,$"},
    Ifc4Product{"IFCFURNISHINGELEMENT", "", ""},
    Ifc4Product{"IFCFURNITURE", kFurniture, ""},
    Ifc4Product{"IFCSYSTEMFURNITUREELEMENT", kFurniture, ""},
    Ifc4Product{"IFCCOLUMN", "", ""},
    Ifc4Product{"IFCCOLUMNSTANDARDCASE", "IFCCOLUMN", ""},
    Ifc4Product{"IFCBEAM", "", ""},
    Ifc4Product{"IFCBEAMSTANDARDCASE", "IFCBEAM", ""},
    Ifc4Product{"IFCMEMBER", "", ""},
    Ifc4Product{"IFCMEMBERSTANDARDCASE", "IFCMEMBER", ""},
    Ifc4Product{"IFCPLATE", "", ""},
    Ifc4Product{"IFCPLATESTANDARDCASE", "IFCPLATE", ""},
    Ifc4Product{"IFCCURTAINWALL", "", ""},
    Ifc4Product{"IFCROOF", "", ",.NOTDEFINED."},
    Ifc4Product{"IFCSTAIR", "", ",.NOTDEFINED."},
    Ifc4Product{"IFCSTAIRFLIGHT", "", ",$,$,$,$"},
    Ifc4Product{"IFCRAMP", "", ",.NOTDEFINED."},
    Ifc4Product{"IFCRAMPFLIGHT", "", ""},
    Ifc4Product{"IFCRAILING", "", ",$"},
    Ifc4Product{"IFCCOVERING", "", ",$"},
    Ifc4Product{"IFCOPENINGELEMENT", "", ""},
    Ifc4Product{"IFCOPENINGSTANDARDCASE", "IFCOPENINGELEMENT", ""},
};

constexpr std::array<std::string_view, 24> kImmaterial = {"IFCALIGNMENT",
                                                          "IFCALIGNMENTCANT",
                                                          "IFCALIGNMENTHORIZONTAL",
                                                          "IFCALIGNMENTSEGMENT",
                                                          "IFCALIGNMENTVERTICAL",
                                                          "IFCANNOTATION",
                                                          "IFCDISTRIBUTIONPORT",
                                                          "IFCEARTHWORKSCUT",
                                                          "IFCEXTERNALSPATIALELEMENT",
                                                          "IFCGRID",
                                                          "IFCPORT",
                                                          "IFCPOSITIONINGELEMENT",
                                                          "IFCREFERENT",
                                                          "IFCSPATIALZONE",
                                                          "IFCSTRUCTURALCURVEACTION",
                                                          "IFCSTRUCTURALCURVECONNECTION",
                                                          "IFCSTRUCTURALCURVEMEMBER",
                                                          "IFCSTRUCTURALPOINTACTION",
                                                          "IFCSTRUCTURALPOINTCONNECTION",
                                                          "IFCSTRUCTURALSURFACEACTION",
                                                          "IFCSTRUCTURALSURFACEMEMBER",
                                                          "IFCSURFACEFEATURE",
                                                          "IFCVIRTUALELEMENT",
                                                          "IFCVOIDINGFEATURE"};

}  // namespace

const Ifc4Rule* ifc4_rule(std::string_view type) { return row_of(kRules, type); }

const Ifc4Product* ifc4_product(std::string_view type) { return row_of(kProducts, type); }

bool is_immaterial_ifc4(std::string_view type) {
  return std::binary_search(kImmaterial.begin(), kImmaterial.end(), type);
}

std::string_view name_of_ifc4_kind(char kind) {
  constexpr std::string_view kKinds = "PDVXABTNCGFUIHSEOLMRQY";
  constexpr std::array<std::string_view, kKinds.size()> kNames = {
      "point",     "direction",     "vector",         "placement of an axis",
      "placement", "placement",     "transformation", "placement",
      "curve",     "segment",       "profile",        "surface",
      "solid",     "half-space",    "shell",          "face",
      "bound",     "loop",          "shape to map",   "representation",
      "shape",     "list of points"};
  const std::size_t at = kKinds.find(kind);
  return at < kNames.size() ? kNames[at] : "entity";
}

}  // namespace rayloc
