// Every mistake in a workflow is one error that names file, line, column, JSON pointer, the value
// and the allowed range, before anything is computed. In the texts below @ marks the place that the
// error must point at; it is taken out before reading, so the expected position is counted
// independently.
#include "workflows/workflow.h"

#include <gtest/gtest.h>
#include <algorithm>
#include <string>
#include <vector>

namespace sigmaflow::workflows {

namespace {

struct Mistake {
    std::string name, text, pointer;
    std::vector<std::string> phrases;
};

std::ostream& operator<<(std::ostream& out, const Mistake& mistake)
{
    return out << mistake.name;
}

/// A workflow with this suspension.
std::string suspension(const std::string& object)
{
    return "{\n  \"suspension\": " + object + ",\n  \"steps\": [{\"step\": \"pack\"}]\n}\n";
}

std::string model(const std::string& object)
{
    return suspension("{\"model\":\n    " + object + "}");
}

/// A workflow with this step after a packing.
std::string step(const std::string& object)
{
    return "{\n  \"suspension\": {},\n  \"steps\": [\n    {\"step\": \"pack\"},\n    " + object +
           "\n  ]\n}\n";
}

/// A workflow with this step after a packing and a shear step of strain 2.
std::string after_shear(const std::string& object)
{
    return step("{\"step\": \"shear\", \"stress\": 1, \"strain\": 2},\n    " + object);
}

std::vector<Mistake> mistakes_of_syntax()
{
    return {
        {"empty", "@", "", {"is empty"}},
        {"blank", "@  \n \t", "", {"is empty"}},
        {"cut_off", "{\"suspension\": {@", "/suspension", {"the text ends too early"}},
        {"trailing_comma",
         "{\"suspension\": {\"particles\": 20,\n @}}",
         "/suspension/particles",
         {"a comma must not stand before }"}},
        {"missing_comma",
         "{\"suspension\": {\"particles\": 20\n @\"seed\": 1}}",
         "/suspension/particles",
         {"unexpected string literal", "'}'"}},
        {"comment",
         "{\n @// twenty particles\n \"suspension\": {}}",
         "",
         {"comments are not allowed"}},
        {"single_quotes", "{@'suspension': {}}", "", {"texts stand in double quotes"}},
        {"not_a_number",
         "{\"suspension\": {\"particles\": @NaN}}",
         "/suspension/particles",
         {"NaN is not a JSON number"}},
        {"infinity",
         "{\"suspension\": {\"particles\": @-Infinity}}",
         "/suspension/particles",
         {"-Infinity is not a JSON number"}},
        {"python_true",
         "{\"suspension\": {\"model\": {\"einstein\": @True}}}",
         "/suspension/model/einstein",
         {"unexpected \"True\""}},
        {"too_large_number",
         "{\"suspension\": {\"volume_fraction\": @1e999}}",
         "/suspension/volume_fraction",
         {"1e999 is too large"}},
        {"leading_plus",
         "{\"suspension\": {\"seed\": @+1}}",
         "/suspension/seed",
         {"unexpected \"+1\""}},
        {"garbage_after_the_end", "{\"suspension\": {}}\n@x", "", {"unexpected \"x\""}},
        {"two_documents", "{}\n@{}", "", {"end of input"}},
        {"repeated_key",
         "{\"suspension\": {\"seed\": 1,\n  @\"seed\": 2}}",
         "/suspension/seed",
         {"stands here twice", "line 1"}},
        {"repeated_key_in_an_array",
         "{\"steps\": [{}, {\"step\": \"pack\",\n @\"step\": \"pack\"}]}",
         "/steps/1/step",
         {"stands here twice", "line 1"}},
        {"byte_order_mark", "@\xEF\xBB\xBF{}", "", {"byte-order mark"}},
        {"bad_utf8", "{\"name\": \"\xC3@\x28\"}", "/name", {"UTF-8"}},
        {"line_break_in_a_text", "{\"name\": \"a@\nb\"}", "/name", {"control character"}},
        {"column_counts_characters_not_bytes",
         "{\"name\": \"σ₀ γ̇\", @\"naem\": 1}",
         "/naem",
         {"did you mean \"name\"?"}},
        {"root_is_an_array", "@[]", "", {"must be an object, got an array of 0 elements"}},
        {"root_is_a_number", "@3", "", {"must be an object, got 3"}},
        {"too_deep", std::string(64, '[') + "@[", "", {"deeper than 64"}},
    };
}

std::vector<Mistake> mistakes_of_the_suspension()
{
    return {
        {"no_suspension", "@{\"steps\": []}", "", {"misses the required key \"suspension\""}},
        {"no_steps", "@{\"suspension\": {}}", "", {"misses the required key \"steps\""}},
        {"misspelt_top_key",
         "{@\"suspention\": {}, \"steps\": []}",
         "/suspention",
         {"unknown key", "did you mean \"suspension\"?", "known: $schema, name, description"}},
        {"misspelt_volume_fraction",
         suspension("{@\"volum_fraction\": 0.5}"),
         "/suspension/volum_fraction",
         {"did you mean \"volume_fraction\"?", "known: particles"}},
        {"swapped_letters",
         suspension("{@\"sede\": 2}"),
         "/suspension/sede",
         {"did you mean \"seed\"?"}},
        {"upper_case",
         suspension("{@\"Particles\": 20}"),
         "/suspension/Particles",
         {"did you mean \"particles\"?"}},
        {"beginning_of_a_key",
         suspension("{@\"volume\": 0.5}"),
         "/suspension/volume",
         {"did you mean \"volume_fraction\"?"}},
        {"end_of_a_key",
         suspension("{@\"shape\": [1, 1, 1]}"),
         "/suspension/shape",
         {"did you mean \"box_shape\"?"}},
        {"nothing_like_it",
         suspension("{@\"temperature\": 1}"),
         "/suspension/temperature",
         {"unknown key (known: particles, volume_fraction"}},
        {"no_particles",
         suspension("{\"particles\": @0}"),
         "/suspension/particles",
         {"must be an integer >= 2 and <= 1000000, got 0"}},
        {"broken_particle",
         suspension("{\"particles\": @1.5}"),
         "/suspension/particles",
         {"must be an integer", "got 1.5"}},
        {"negative_particles",
         suspension("{\"particles\": @-20}"),
         "/suspension/particles",
         {"got -20"}},
        {"a_million_million_particles",
         suspension("{\"particles\": @1000000000000}"),
         "/suspension/particles",
         {"<= 1000000, got 1000000000000"}},
        {"particles_beyond_64_bits",
         suspension("{\"particles\": @99999999999999999999}"),
         "/suspension/particles",
         {"got 99999999999999999999"}},
        {"particles_as_text",
         suspension("{\"particles\": @\"20\"}"),
         "/suspension/particles",
         {"must be an integer", "got \"20\""}},
        {"too_dense",
         suspension("{\"volume_fraction\": @0.88}"),
         "/suspension/volume_fraction",
         {"must be <= 0.6528, random close packing of these spheres, got 0.88"}},
        {"too_dense_for_equal_spheres",
         suspension("{\"size_ratio\": 1, \"volume_fraction\": @0.645}"),
         "/suspension/volume_fraction",
         {"must be <= 0.64, random close packing"}},
        {"too_dense_for_given_radii",
         suspension("{\"radii\": [1, 1, 1, 1], \"volume_fraction\": @0.65}"),
         "/suspension/volume_fraction",
         {"must be <= 0.64, random close packing"}},
        {"too_dense_packing",
         "{\n  \"suspension\": {},\n  \"steps\": [{\"step\": \"pack\", \"volume_fraction\": "
         "@0.66}]\n}\n",
         "/steps/0/volume_fraction",
         {"must be <= 0.6528, random close packing of these spheres, got 0.66"}},
        {"no_solid",
         suspension("{\"volume_fraction\": @0}"),
         "/suspension/volume_fraction",
         {"must be > 0 and <= 1, got 0"}},
        {"volume_fraction_null",
         suspension("{\"volume_fraction\": @null}"),
         "/suspension/volume_fraction",
         {"must be a number > 0 and <= 1, got null"}},
        {"negative_seed",
         suspension("{\"seed\": @-1}"),
         "/suspension/seed",
         {"must be an integer >= 0", "got -1"}},
        {"seed_beyond_64_bits",
         suspension("{\"seed\": @18446744073709551616}"),
         "/suspension/seed",
         {"< 2^64, got 18446744073709551616"}},
        {"two_box_lengths",
         suspension("{\"box_shape\": @[1, 1]}"),
         "/suspension/box_shape",
         {"must be an array of 3 numbers, got an array of 2 elements"}},
        {"flat_box",
         suspension("{\"box_shape\": [1, @0, 1]}"),
         "/suspension/box_shape/1",
         {"must be >= 0.01", "got 0"}},
        {"negative_radius",
         suspension("{\"radii\": [1, 1.4,\n @-1]}"),
         "/suspension/radii/2",
         {"[a], got -1"}},
        {"radius_as_text",
         suspension("{\"radii\": [1, @\"1.4\"]}"),
         "/suspension/radii/1",
         {"must be a number", "got \"1.4\""}},
        {"radii_and_another_number",
         suspension("{\"particles\": @3, \"radii\": [1, 1.4]}"),
         "/suspension/particles",
         {"number of radii, 2, got 3"}},
        {"radii_and_size_ratio",
         suspension("{\"radii\": [1, 1.4], @\"size_ratio\": 1.4}"),
         "/suspension/size_ratio",
         {"radii already says"}},
        {"model_is_a_text",
         suspension("{\"model\": @\"frictional\"}"),
         "/suspension/model",
         {"must be an object, got \"frictional\""}},
        {"misspelt_friction",
         model("{@\"friction_statc\": 1}"),
         "/suspension/model/friction_statc",
         {"did you mean \"friction_static\"?"}},
        {"negative_friction",
         model("{\"friction_static\": @-1}"),
         "/suspension/model/friction_static",
         {"must be >= 0 and <= 1e+06, got -1"}},
        {"dynamic_above_static",
         model("{\"friction_static\": 0.5, @\"friction_dynamic\": 1}"),
         "/suspension/model/friction_dynamic",
         {"must be <= friction_static, got 1 and 0.5"}},
        {"static_below_default_dynamic",
         model("{@\"friction_static\": 0.5}"),
         "/suspension/model/friction_static",
         {"friction_dynamic must be <=", "got 1 and 0.5"}},
        {"no_drag",
         model("{\"drag_factor\": @0}"),
         "/suspension/model/drag_factor",
         {"must be >= 1e-06 and <= 1e+06, got 0"}},
        {"no_debye_length",
         model("{\"debye_length\": @0}"),
         "/suspension/model/debye_length",
         {"must be >= 1e-06 and <= 1000 [a], got 0"}},
        {"unknown_amplitude",
         model("{\"repulsion_amplitude\": @\"derjagiun\"}"),
         "/suspension/model/repulsion_amplitude",
         {"one of reduced_radius, derjaguin, constant", "did you mean \"derjaguin\"?"}},
        {"einstein_as_number",
         model("{\"einstein\": @1}"),
         "/suspension/model/einstein",
         {"must be true or false, got 1"}},
    };
}

std::vector<Mistake> mistakes_of_the_steps()
{
    return {
        {"no_step", "{\"suspension\": {}, \"steps\": @[]}", "/steps", {"1 to 1000 elements"}},
        {"steps_as_object",
         "{\"suspension\": {}, \"steps\": @{}}",
         "/steps",
         {"must be an array, got an object"}},
        {"step_as_text",
         "{\"suspension\": {}, \"steps\": [@\"pack\"]}",
         "/steps/0",
         {"must be an object, got \"pack\""}},
        {"step_without_kind",
         step("@{\"stress\": 2}"),
         "/steps/1",
         {"misses the required key \"step\""}},
        {"unknown_step",
         step("{\"step\": @\"sheer\"}"),
         "/steps/1/step",
         {"one of pack, equilibrate, shear", "did you mean \"shear\"?"}},
        {"misspelt_parameter",
         step("{\"step\": \"shear\", @\"stres\": 2}"),
         "/steps/1/stres",
         {"did you mean \"stress\"?"}},
        {"parameter_of_another_step",
         step("{\"step\": \"shear\", \"stress\": 2, @\"bins\": 20}"),
         "/steps/1/bins",
         {"unknown key (known: step, name, strain"}},
        {"negative_stress",
         step("{\"step\": \"shear\",\n     \"stress\": @-1}"),
         "/steps/1/stress",
         {"must be >= 1e-06", "[sigma0], got -1"}},
        {"stress_and_rate",
         step("{\"step\": \"shear\", \"stress\": 2, @\"rate\": 1}"),
         "/steps/1/rate",
         {"exclude each other"}},
        {"neither_stress_nor_rate",
         step("@{\"step\": \"shear\"}"),
         "/steps/1",
         {"either stress [sigma0] or rate [rate0]"}},
        {"rate_with_stiffness_by_stress",
         step("{\"step\": \"shear\", @\"rate\": 1}"),
         "/steps/1/rate",
         {"stiffness_scale", "fixed"}},
        {"no_strain",
         step("{\"step\": \"shear\", \"stress\": 2, \"strain\": @0}"),
         "/steps/1/strain",
         {"must be > 0", "got 0"}},
        {"too_many_rows",
         step("{\"step\": \"shear\", \"stress\": 2, \"strain\": 1000, @\"series_interval\": 1e-6}"),
         "/steps/1/series_interval",
         {"more than 1e7 rows"}},
        {"too_many_frames",
         step("{\"step\": \"shear\", \"stress\": 2, \"strain\": 1000, @\"frame_interval\": 1e-4}"),
         "/steps/1/frame_interval",
         {"more than 99999 frames"}},
        {"unknown_scheme",
         step("{\"step\": \"shear\", \"stress\": 2, \"scheme\": @\"huen\"}"),
         "/steps/1/scheme",
         {"one of implicit, heun, euler", "did you mean \"heun\"?"}},
        {"implicit_dashpots",
         "{\"suspension\": {\"model\": {\"contact_hydrodynamics\": \"dashpot\"}}, \"steps\": "
         "[{\"step\": \"pack\"}, @{\"step\": \"shear\", \"stress\": 2}]}",
         "/steps/1/scheme",
         {"\"implicit\" (the default) needs contact_hydrodynamics", "\"heun\" can do"}},
        {"coarse_steps",
         step("{\"step\": \"shear\", \"stress\": 2, \"displacement\": @1}"),
         "/steps/1/displacement",
         {"<= 0.1 [a], got 1"}},
        {"shear_without_packing",
         "{\"suspension\": {}, \"steps\": [@{\"step\": \"shear\", \"stress\": 2}]}",
         "/steps/0",
         {"needs particles: put a step \"pack\" before it"}},
        {"window_too_wide",
         step("{\"step\": \"equilibrate\", \"stress\": 2, @\"minimum_strain\": 0.5}"),
         "/steps/1/minimum_strain",
         {">= 2 * window = 1, got 0.5"}},
        {"maximum_below_minimum",
         step("{\"step\": \"equilibrate\", \"stress\": 2, @\"maximum_strain\": 0.5}"),
         "/steps/1/maximum_strain",
         {">= minimum_strain = 1, got 0.5"}},
        {"window_of_one_row",
         step("{\"step\": \"equilibrate\", \"stress\": 2, @\"window\": 0.01}"),
         "/steps/1/window",
         {">= 4 * series_interval"}},
        {"profile_without_run",
         step("@{\"step\": \"velocity_profile\"}"),
         "/steps/1",
         {"needs a run: put a step \"shear\" before it"}},
        {"profile_of_an_equilibration",
         step("{\"step\": \"equilibrate\", \"stress\": 2},\n @{\"step\": \"velocity_profile\"}"),
         "/steps/2",
         {"put a step \"shear\" before it"}},
        {"profile_of_an_unknown_run",
         after_shear("{\"step\": \"velocity_profile\", \"of\": @\"sheer\"}"),
         "/steps/2/of",
         {"must be one of shear", "did you mean \"shear\"?"}},
        {"weights_of_other_number",
         after_shear("{\"step\": \"stability\", \"relaxation_strains\": [0.02, 0.002], "
                     "\"weights\": @[1]}"),
         "/steps/2/weights",
         {"must have 2 numbers, one for each of relaxation_strains"}},
        {"gap_flow_of_an_unknown_curve",
         step("{\"step\": \"shear\", \"sweep\": {\"stress\": [1, 2]}},\n    "
              "{\"step\": \"one_dimensional_flow\", \"volume_fraction\": @0.3}"),
         "/steps/2/volume_fraction",
         {"must be one that was sheared at imposed stresses"}},
        {"one_bin",
         after_shear("{\"step\": \"velocity_profile\", \"bins\": @1}"),
         "/steps/2/bins",
         {">= 2 and <= 1000, got 1"}},
        {"profile_after_the_end",
         after_shear("{\"step\": \"velocity_profile\", \"from_strain\": @3}"),
         "/steps/2/from_strain",
         {"must be <= 2, the strain of \"shear\", got 3"}},
        {"snapshot_after_the_end",
         after_shear("{\"step\": \"snapshot\", \"strain\": @2.5}"),
         "/steps/2/strain",
         {"must be <= 2, the strain of \"shear\", got 2.5"}},
        {"snapshot_before_the_run",
         step("@{\"step\": \"snapshot\"},\n {\"step\": \"shear\", \"stress\": 2}"),
         "/steps/1",
         {"needs a run"}},
        {"unknown_colour_map",
         after_shear("{\"step\": \"snapshot\", \"colour_map\": @\"jet\"}"),
         "/steps/2/colour_map",
         {"one of inferno, viridis, paper, got \"jet\""}},
        {"american_colour",
         after_shear("{\"step\": \"snapshot\", @\"color_map\": \"paper\"}"),
         "/steps/2/color_map",
         {"did you mean \"colour_map\"?"}},
        {"huge_picture",
         after_shear("{\"step\": \"snapshot\", \"width\": @100000}"),
         "/steps/2/width",
         {">= 64 and <= 16384, got 100000"}},
        {"unknown_scalar",
         after_shear("{\"step\": \"plot\", \"y\": @\"viscocity\"}"),
         "/steps/2/y",
         {"did you mean \"viscosity\"?"}},
        {"name_with_a_path",
         step("{\"step\": \"pack\", \"name\": @\"../evil\"}"),
         "/steps/1/name",
         {"letters, digits, _ or -", "got \"../evil\""}},
        {"empty_name",
         step("{\"step\": \"pack\", \"name\": @\"\"}"),
         "/steps/1/name",
         {"1 to 64 letters"}},
        {"repeated_name",
         step("{\"step\": \"pack\", \"name\": \"a\"},\n {\"step\": \"pack\", \"name\": @\"a\"}"),
         "/steps/2/name",
         {"must be different for every step, got \"a\""}},
        {"name_of_a_file",
         step("{\"step\": \"pack\", \"name\": @\"run.h5\"}"),
         "/steps/1/name",
         {"letters, digits, _ or -"}},
    };
}

std::vector<Mistake> mistakes_of_sweeps()
{
    const auto shear = [](const std::string& more) {
        return step("{\"step\": \"shear\", " + more + "}");
    };
    return {
        {"sweep_value",
         shear("\"sweep\": {\"stress\": [1, @-2]}"),
         "/steps/1/sweep/stress/1",
         {"must be >= 1e-06 and <= 1e+09 [sigma0], got -2"}},
        {"sweep_type",
         shear("\"sweep\": {\"stress\": @2}"),
         "/steps/1/sweep/stress",
         {"must be an array"}},
        {"sweep_of_nothing",
         shear("\"sweep\": {\"stress\": @[]}"),
         "/steps/1/sweep/stress",
         {"1 to 1000"}},
        {"sweep_unknown",
         shear("\"stress\": 1, \"sweep\": {@\"strian\": [1]}"),
         "/steps/1/sweep/strian",
         {"did you mean \"strain\"?"}},
        {"sweep_of_kinds",
         step("{@\"step\": \"shear\", \"stress\": 1, \"sweep\": {\"step\": [\"pack\"]}}"),
         "/steps/1/step",
         {"is in the sweep as well"}},
        {"sweep_of_names",
         shear("\"stress\": 1, \"sweep\": @{\"name\": [\"a\"]}"),
         "/steps/1/sweep",
         {"cannot be of \"name\""}},
        {"sweep_of_two",
         shear("\"sweep\": @{\"stress\": [1], \"strain\": [1]}"),
         "/steps/1/sweep",
         {"one parameter with a list of values"}},
        {"sweep_and_value",
         shear("@\"stress\": 1, \"sweep\": {\"stress\": [1]}"),
         "/steps/1/stress",
         {"is in the sweep as well"}},
        {"sweep_twice",
         shear("\"sweep\": {\"stress\": [1, 2, @1]}"),
         "/steps/1/sweep/stress/2",
         {"must be different for every step, got 1"}},
        {"sweep_exponent",
         shear("\"sweep\": {\"stress\": [@1e+1]}"),
         "/steps/1/sweep/stress/0",
         {"must be a number or a word that can be a part of the name"}},
        {"flow_curve_without_runs",
         step("@{\"step\": \"flow_curve\"}"),
         "/steps/1",
         {"needs steps \"shear\" at imposed stresses before it"}},
        {"flow_curve_of_one_stress",
         after_shear("@{\"step\": \"flow_curve\"}"),
         "/steps/2",
         {"needs runs at two stresses"}},
        {"panels_before_any_picture",
         after_shear("@{\"step\": \"panels\", \"of\": [\"shear\"]}"),
         "/steps/2",
         {"needs pictures"}},
        {"panels_of_a_step_that_draws_nothing",
         after_shear("{\"step\": \"plot\"}, {\"step\": \"snapshot\"},\n {\"step\": \"panels\", "
                     "\"of\": [\"plot\", @\"shear\"]}"),
         "/steps/4/of/1",
         {"must be one of plot, snapshot, got \"shear\""}},
        {"panels_of_a_later_step",
         after_shear("{\"step\": \"plot\"}, {\"step\": \"panels\", \"of\": [@\"snapshot\"]},\n"
                     "{\"step\": \"snapshot\"}"),
         "/steps/3/of/0",
         {"must be one of plot, got \"snapshot\""}},
        {"panels_of_nothing",
         after_shear("{\"step\": \"plot\"}, {\"step\": \"panels\", \"of\": @[]}"),
         "/steps/3/of",
         {"must have 1 to 26 elements"}},
        {"panels_without_a_list",
         after_shear("{\"step\": \"plot\"}, @{\"step\": \"panels\"}"),
         "/steps/3",
         {"misses the required key \"of\""}},
        {"panels_of_a_number",
         after_shear("{\"step\": \"plot\"}, {\"step\": \"panels\", \"of\": [@3]}"),
         "/steps/3/of/0",
         {"must be a text"}},
        {"panels_in_more_columns_than_pictures",
         after_shear("{\"step\": \"plot\"}, {\"step\": \"panels\", \"of\": [\"plot\"], "
                     "\"columns\": @2}"),
         "/steps/3/columns",
         {"must be <= 1, the number of pictures, got 2"}},
        {"panels_higher_than_programs_show",
         after_shear("{\"step\": \"plot\"}, @{\"step\": \"panels\", \"of\": [\"plot\", \"plot\", "
                     "\"plot\", \"plot\"], \"columns\": 1, \"width\": 16384}"),
         "/steps/3",
         {"must be <= 65535", "more columns"}},
        {"wyart_cates_of_one_volume_fraction",
         step("{\"step\": \"shear\", \"sweep\": {\"stress\": [1, 2]}, \"strain\": 2},\n"
              "    @{\"step\": \"wyart_cates\"}"),
         "/steps/2",
         {"needs runs at imposed stresses at two volume fractions"}},
        {"wyart_cates_without_runs",
         step("@{\"step\": \"wyart_cates\"}"),
         "/steps/1",
         {"needs steps \"shear\" at imposed stresses before it"}},
    };
}

std::vector<Mistake> mistakes_of_ensembles()
{
    return {
        {"a_step_that_is_none",
         step("{\"step\": \"step_stress\", @\"stress_after\": 2}"),
         "/steps/1/stress_after",
         {"must differ from stress_before"}},
        {"a_step_with_too_few_samples",
         step("{\"step\": \"step_stress\", \"strain_after\": 0.1, @\"series_interval\": 0.05}"),
         "/steps/1/series_interval",
         {"must give 10 to 1e5 samples"}},
        {"an_ensemble_of_one",
         step("{\"step\": \"step_stress\", \"starts\": @1}"),
         "/steps/1/starts",
         {"must be"}},
        {"an_implicit_ensemble_of_dashpots",
         step("@{\"step\": \"step_stress\", \"model\": {\"contact_hydrodynamics\": \"dashpot\"}}"),
         "/steps/1/scheme",
         {"needs contact_hydrodynamics"}},
        {"jamming_stresses_the_wrong_way",
         step("{\"step\": \"jamming\", \"lowest_stress\": 3, @\"highest_stress\": 2}"),
         "/steps/1/highest_stress",
         {"must be > lowest_stress, 3"}},
        {"jamming_in_two_words",
         step("{\"step\": \"jamming\", \"volume_fraction\": 0.5, \"volume_fractions\": @[0.5]}"),
         "/steps/1/volume_fractions",
         {"exclude each other"}},
        {"jamming_of_what_cannot_be_packed",
         step("{\"step\": \"jamming\", \"volume_fractions\": [0.5, @0.7]}"),
         "/steps/1/volume_fractions/1",
         {"random close packing"}},
        {"an_adaptive_curve_of_fewer_points_than_it_begins_with",
         step("{\"step\": \"adaptive_flow_curve\", \"points\": 9, @\"most_points\": 8}"),
         "/steps/1/most_points",
         {"must be >= points, 9"}},
        {"an_adaptive_curve_that_may_not_begin",
         step("{\"step\": \"adaptive_flow_curve\", \"strain\": 3, @\"maximum_strain\": 1}"),
         "/steps/1/maximum_strain",
         {"must be >= strain, 3"}},
        {"a_comparison_without_runs",
         step("@{\"step\": \"compare\"}"),
         "/steps/1",
         {"needs two steps"}},
        {"fluctuations_without_runs",
         step("@{\"step\": \"fluctuations\"}"),
         "/steps/1",
         {"needs a run"}},
        {"statistics_without_runs",
         step("@{\"step\": \"statistics\"}"),
         "/steps/1",
         {"needs a run"}},
        {"a_response_that_was_not_measured",
         step("{\"step\": \"stability\", @\"response\": \"none\"}"),
         "/steps/1/response",
         {"needs a step"}},
        {"too_many_particles_for_a_pack",
         step("{\"step\": \"pack\", \"particles\": @1}"),
         "/steps/1/particles",
         {"must be"}},
        {"a_pack_that_is_too_small_for_its_forces",
         step("@{\"step\": \"pack\", \"particles\": 4}"),
         "/steps/1",
         {"too few particles"}},
    };
}

std::vector<Mistake> all_mistakes()
{
    std::vector<Mistake> all = mistakes_of_syntax();
    for (const auto& more : {mistakes_of_the_suspension(), mistakes_of_the_steps(),
                             mistakes_of_sweeps(), mistakes_of_ensembles()})
        all.insert(all.end(), more.begin(), more.end());
    return all;
}

/// "line:column" of the marker, columns in characters.
std::string marked_place(const std::string& text, std::size_t marker)
{
    int line = 1, column = 1;
    for (char c : text.substr(0, marker)) {
        if (c == '\n') {
            ++line;
            column = 1;
        } else if ((c & 0xC0) != 0x80)
            ++column;
    }
    return std::to_string(line) + ":" + std::to_string(column);
}

}

class WrongWorkflow : public testing::TestWithParam<Mistake> {};

TEST_P(WrongWorkflow, IsRefusedWithPlacePointerAndReason)
{
    std::string text = GetParam().text;
    const std::size_t marker = text.find('@');
    ASSERT_NE(marker, std::string::npos);
    text.erase(marker, 1);
    std::string expected = "wrong.json:" + marked_place(text, marker) + ": ";
    if (!GetParam().pointer.empty()) expected += GetParam().pointer + ": ";
    try {
        parse_workflow(text, "wrong.json");
        FAIL() << "was accepted:\n" << text;
    } catch (const Error& error) {
        const std::string message = error.what();
        EXPECT_EQ(error.kind(), ErrorKind::input);
        EXPECT_EQ(message.substr(0, expected.size()), expected) << message;
        for (const std::string& phrase : GetParam().phrases)
            EXPECT_NE(message.find(phrase), std::string::npos) << phrase << "\n" << message;
    }
}

INSTANTIATE_TEST_SUITE_P(Table, WrongWorkflow, testing::ValuesIn(all_mistakes()),
                         [](const auto& one) { return one.param.name; });

TEST(WrongWorkflows, AreAtLeastFifty)
{
    EXPECT_GE(all_mistakes().size(), 50u);
}

}
