#include "io/case_file.h"

#include "engine/checks.h"
#include "engine/error.h"
#include "engine/lubrication/pair_resistance.h"
#include "engine/pairs.h"
#include "engine/power_balance.h"
#include "engine/step.h"
#include "io/atomic_file.h"
#include "io/model_fields.h"
#include "io/state_check.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace sigmaflow::io {

using Json = nlohmann::ordered_json;

namespace {

Json list(const Vec3& v)
{
    return {v.x(), v.y(), v.z()};
}

Json list(const Mat3& m)
{
    Json rows = Json::array();
    for (int r = 0; r < 3; ++r) rows.push_back({m(r, 0), m(r, 1), m(r, 2)});
    return rows;
}

template <class Items, class Make>
Json array_of(const Items& items, const Make& make)
{
    Json result = Json::array();
    for (const auto& item : items) result.push_back(make(item));
    return result;
}

// Far beyond anything physical, small enough for every product in the engine.
constexpr Range coordinate = between(-1e9, 1e9), box_length = above_to(0, 1e6);  // [a]
constexpr Range stretch = between(-100, 100), sphere_radius = between(0.01, 100);
constexpr Range velocity = between(-1e9, 1e9);  // [a rate0], [rate0]

Contact read_contact(const JsonNode& node, int particles)
{
    node.refuse_other_keys({"i", "j", "spring", "rolling", "sliding"});
    Contact c;
    c.i = static_cast<int>(node.member("i").integer(0, particles - 1));
    c.j = static_cast<int>(node.member("j").integer(0, particles - 1));
    if (c.i >= c.j) throw node.error("needs i < j");
    c.spring = node.member("spring").vector(stretch, "a");
    if (const auto rolling = node.find("rolling")) c.rolling = rolling->vector(stretch, "a");
    if (const auto sliding = node.find("sliding")) c.sliding = sliding->boolean();
    return c;
}

Json pair_json(const PairState& p, const PairForces& f, const ContactLoad* contact,
               const Vec3& slip)
{
    return {{"i", p.pair.i},
            {"j", p.pair.j},
            {"image", p.pair.image},
            {"gap", p.pair.gap},
            {"xi", p.pair.xi},
            {"normal", list(p.pair.normal)},
            {"load", contact ? contact->load : 0.},
            {"friction", list(contact ? contact->friction : Vec3(Vec3::Zero()))},
            {"slip_velocity", list(slip)},
            {"force_on_i",
             {{"lubrication", list(f.lubrication)},
              {"dashpot", list(f.dashpot)},
              {"contact", list(f.contact)},
              {"repulsion", list(f.repulsion)}}}};
}

Json pairs_json(const Case& one, const Evaluation& e)
{
    const auto forces = pair_forces(one.state, e);
    Json rows = Json::array();
    const auto show = [&](std::size_t row) {
        const PairState& p = e.pairs[row];
        rows.push_back(pair_json(p, forces[row], p.contact < 0 ? nullptr : &e.contacts[p.contact],
                                 relative_motion(one.state, e, p.pair).slip));
    };
    if (one.pair_rows.empty())
        for (std::size_t row = 0; row < e.pairs.size(); ++row) show(row);
    for (int row : one.pair_rows) show(static_cast<std::size_t>(row));
    return rows;
}

Json stress_json(const DetailedEvaluation& e)
{
    Json stress;
    for (std::size_t p = 0; p < e.stress.size(); ++p)
        stress[std::string(stress_part_names[p])] = list(e.stress[p]);
    stress["total"] = list(e.total_stress());
    return stress;
}

Json power_json(const PowerBalance& p)
{
    return {{"input", p.input},
            {"solvent", p.solvent},
            {"drag", p.drag},
            {"torque_residual", p.torque_residual},
            {"lubrication", p.lubrication},
            {"dashpot", p.dashpot},
            {"contact", p.contact},
            {"repulsion", p.repulsion}};
}

Json columns_json(const DetailedEvaluation& e)
{
    Json columns;
    for (std::size_t c = 0; c < column_names.size(); ++c)
        columns[std::string(column_names[c])] = array_of(e.column[c], [](const Vec6& v) {
            return Json(std::vector<double>(v.begin(), v.end()));
        });
    return columns;
}

/// One entry of a case of kind "pairs".
struct PairCase {
    double radius_i, radius_j, xi, delta;
    Vec3 normal;
    Mat3 rate_of_strain;
    Vec6 nonaffine_i, nonaffine_j;
};

PairCase read_pair(const JsonNode& node)
{
    node.refuse_other_keys({"ai", "aj", "xi", "delta", "normal", "E", "W", "expected"});
    PairCase pair;
    pair.radius_i = node.member("ai").number(sphere_radius, "a");
    pair.radius_j = node.member("aj").number(sphere_radius, "a");
    pair.xi = node.member("xi").number(between(deepest_overlap, 10));
    pair.delta = node.member("delta").number(between(1e-9, 1));
    pair.normal = node.member("normal").vector();
    if (std::abs(pair.normal.norm() - 1) > 1e-9)
        throw node.member("normal").error("must have the length 1, has " +
                                          number_text(pair.normal.norm()));
    pair.rate_of_strain = node.member("E").matrix();
    const auto velocities = node.member("W").elements(Length::exactly(2));
    pair.nonaffine_i = Vec6(velocities[0].numbers(Length::exactly(6), velocity).data());
    pair.nonaffine_j = Vec6(velocities[1].numbers(Length::exactly(6), velocity).data());
    return pair;
}

std::vector<PairCase> read_pairs(const JsonNode& root)
{
    root.refuse_other_keys({"kind", "name", "description", "provenance", "cases"});
    std::vector<PairCase> pairs;
    for (const JsonNode& node : root.member("cases").elements({.minimum = 1}))
        pairs.push_back(read_pair(node));
    return pairs;
}

Json pair_case_json(const PairCase& pair)
{
    const auto [L, l] = lubrication::gap_factors(pair.xi, pair.delta);
    const auto r =
        lubrication::scaled(lubrication::pair_coefficients(pair.radius_i, pair.radius_j), L, l);
    const Vec3& n = pair.normal;
    const Mat3& E = pair.rate_of_strain;

    const auto table = [](double v11, double v12, double v21, double v22) {
        return Json{{v11, v12}, {v21, v22}};
    };
    Json block = Json::array();
    Eigen::Matrix<double, 12, 12> matrix;
    for (int c = 0; c < 12; ++c) {
        const Vec6 vi = c < 6 ? Vec6(Vec6::Unit(c)) : Vec6(Vec6::Zero());
        const Vec6 vj = c < 6 ? Vec6(Vec6::Zero()) : Vec6(Vec6::Unit(c - 6));
        const auto load = lubrication::resistance_times(r, n, vi, vj);
        matrix.col(c) << load.force_i, load.torque_i, load.force_j, load.torque_j;
    }
    for (int row = 0; row < 12; ++row) {
        const Eigen::VectorXd values = matrix.row(row);
        block.push_back(std::vector<double>(values.begin(), values.end()));
    }
    const auto strain = lubrication::strain_load(r, n, E);
    const auto six = [](const Vec3& f, const Vec3& t) {
        return Json{f.x(), f.y(), f.z(), t.x(), t.y(), t.z()};
    };
    const auto su = lubrication::velocity_stresslet(r, n, pair.nonaffine_i, pair.nonaffine_j);
    const auto se = lubrication::strain_stresslet(r, n, E);
    return {
        {"scalars",
         {{"XA", table(r.xa, -r.xa, -r.xa, r.xa)},
          {"YA", table(r.ya, -r.ya, -r.ya, r.ya)},
          {"YB", table(r.yb11, -r.yb11, r.yb21, -r.yb21)},
          {"XG", table(r.xg11, -r.xg11, r.xg21, -r.xg21)},
          {"YG", table(r.yg11, -r.yg11, r.yg21, -r.yg21)},
          {"YC", table(r.yc11, r.yc12, r.yc12, r.yc22)},
          {"YH", table(r.yh11, r.yh12, r.yh21, r.yh22)},
          {"XM", table(r.xm11, r.xm12, r.xm12, r.xm22)},
          {"YM", table(r.ym11, r.ym12, r.ym12, r.ym22)}}},
        {"R_FU", block},
        {"R_FE_E", {six(strain.force_i, strain.torque_i), six(strain.force_j, strain.torque_j)}},
        {"minus_R_SU_W", {list(su.on_i), list(su.on_j)}},
        {"R_SE_E", {list(se.on_i), list(se.on_j)}}};
}

TrajectoryPlan read_plan(const JsonNode& expected)
{
    constexpr double most_steps = 1e6;
    TrajectoryPlan plan;
    const JsonNode strains = expected.member("strain"),
                   interval = expected.member("strain_interval");
    plan.strain = strains.numbers({.minimum = 1}, between(0, 1e4));
    plan.interval = interval.number(between(1e-6, 100));
    for (std::size_t k = 0; k < plan.strain.size(); ++k)
        if (std::abs(plan.strain[k] - static_cast<double>(k) * plan.interval) >
            1e-6 * plan.interval)
            throw strains.element(k).wrong(
                "must be " + std::to_string(k) +
                " times strain_interval = " + number_text(plan.interval));
    // half the coarse step: its error is stated in the files
    plan.step = plan.interval / 100;
    if (const auto coarse = expected.find("coarse_step"))
        plan.step = coarse->number(above_to(0, plan.interval)) / 2;
    if (plan.strain.back() / plan.step > most_steps)
        throw expected.error("needs more than 1e6 steps: the last strain is " +
                             number_text(plan.strain.back()) + ", a step " +
                             number_text(plan.step));
    return plan;
}

/// An error of the computation, which does not know the file.
template <class Work>
auto naming_the_file(const std::filesystem::path& path, const Work& work)
{
    try {
        return work();
    } catch (const Error& error) {
        throw error.within(path.string());
    }
}

std::size_t kind_of(const JsonNode& root)
{
    return root.member("kind").word({"instant", "trajectory", "pairs"});
}

}

State read_state(const JsonNode& node)
{
    node.refuse_other_keys({"box", "offset", "positions", "radii", "contacts"});
    State s;
    s.box.length = node.member("box").vector(box_length, "a");
    s.box.offset = node.member("offset").number(coordinate, "a");
    s.radius = node.member("radii").numbers({.minimum = 1}, sphere_radius, "a");
    s.position =
        node.member("positions").vectors(Length::exactly(s.radius.size()), coordinate, "a");
    for (const JsonNode& contact : node.member("contacts").elements())
        s.contacts.push_back(read_contact(contact, s.size()));
    const auto before = [](const Contact& p, const Contact& q) {
        return p.i < q.i || (p.i == q.i && p.j < q.j);
    };
    std::sort(s.contacts.begin(), s.contacts.end(), before);
    for (std::size_t k = 1; k < s.contacts.size(); ++k)
        if (!before(s.contacts[k - 1], s.contacts[k]))
            throw node.member("contacts")
                .error("pair (" + std::to_string(s.contacts[k].i) + ", " +
                       std::to_string(s.contacts[k].j) + ") is listed twice");
    return s;
}

Json state_json(const State& s)
{
    const auto contact = [](const Contact& c) {
        return Json{{"i", c.i},
                    {"j", c.j},
                    {"spring", list(c.spring)},
                    {"rolling", list(c.rolling)},
                    {"sliding", c.sliding}};
    };
    return {{"box", list(s.box.length)},
            {"offset", s.box.offset},
            {"positions", array_of(s.position, [](const Vec3& x) { return list(x); })},
            {"radii", s.radius},
            {"contacts", array_of(s.contacts, contact)}};
}

namespace {

std::vector<int> read_rows(const JsonNode& node, const Case& one, double range)
{
    NeighbourList list;
    list.update(one.state, range);
    const std::size_t pairs = find_pairs(one.state, range, list).size();
    std::vector<int> rows;
    for (const JsonNode& row : node.elements()) {
        if (pairs == 0) throw row.error("there are no pairs in range");
        rows.push_back(static_cast<int>(row.integer(0, static_cast<std::int64_t>(pairs) - 1)));
    }
    return rows;
}

}

Case read_case(const JsonNode& root)
{
    root.refuse_other_keys({"kind", "name", "description", "provenance", "model", "control", "n",
                            "pair_rows", "state", "expected"});
    Case one;
    one.state = read_state(root.member("state"));
    if (const auto n = root.find("n"))
        if (n->integer(1, 1000000000) != one.state.size())
            throw n->wrong("must be the number of radii, " + std::to_string(one.state.size()));
    if (const auto model = root.find("model")) one.model = read_model(*model);
    one.control = read_control(root.member("control"), one.model);
    const double range = std::max(one.model.lubrication_range, one.model.repulsion_range);
    check_state(one.state, range, root.member("state"));
    if (const auto rows = root.find("pair_rows")) one.pair_rows = read_rows(*rows, one, range);
    return one;
}

Json observables_json(const Case& one)
{
    Workspace workspace;
    const DetailedEvaluation d = evaluate_in_detail(one.state, one.model, one.control, workspace);
    const Evaluation& e = d.evaluation;
    const Sample sample = make_sample(one.state, d);
    const Velocities v = total_velocities(one.state, e);
    double sum_of_xi = 0;
    for (const PairState& p : e.pairs) sum_of_xi += p.pair.xi;
    const auto count = [&](auto&& holds) {
        return std::count_if(e.contacts.begin(), e.contacts.end(), holds);
    };
    return {
        {"shear_rate", e.shear_rate},
        {"shear_stress", sample.shear_stress},
        {"viscosity", sample.viscosity},
        {"N1", sample.normal_stress_difference_1},
        {"N2", sample.normal_stress_difference_2},
        {"particle_pressure", sample.particle_pressure},
        {"volume_fraction", volume_fraction(one.state)},
        {"stress", stress_json(d)},
        {"power", power_json(power_balance(one.state, d))},
        {"pairs_in_range", e.pairs.size()},
        {"contacts", e.contacts.size()},
        {"frictional_contacts", count([](const ContactLoad& c) { return c.frictional; })},
        {"sliding_contacts", count([](const ContactLoad& c) { return c.memory.sliding; })},
        {"smallest_xi", sample.smallest_xi},
        {"sum_of_xi", sum_of_xi},
        {"displacement_time_step", displacement_time_step(e, 1e-3)},
        {"pairs", pairs_json(one, e)},
        {"nonaffine_speed",
         array_of(e.nonaffine, [](const Vec6& w) { return w.head<3>().norm(); })},
        {"velocity", array_of(v, [](const Vec6& w) { return list(Vec3(w.head<3>())); })},
        {"angular_velocity", array_of(v, [](const Vec6& w) { return list(Vec3(w.tail<3>())); })},
        {"columns", columns_json(d)},
        {"particle_stress",
         array_of(particle_stress(one.state, d), [](const Mat3& S) { return list(S); })}};
}

Json trajectory_json(const Case& one, const TrajectoryPlan& plan)
{
    Workspace workspace({SolverKind::cholesky});
    State s = one.state;
    const bool by_stress = std::holds_alternative<ImposedStress>(one.control);
    const auto every = static_cast<long>(std::lround(plan.interval / plan.step));
    Json value = Json::array(), contacts = Json::array(), time = Json::array();
    for (std::size_t point = 0;; ++point) {
        const DetailedEvaluation d = evaluate_in_detail(s, one.model, one.control, workspace);
        Evaluation e = d.evaluation;
        value.push_back(by_stress ? e.shear_rate : d.total_stress()(flow, gradient));
        contacts.push_back(e.contacts.size());
        time.push_back(s.time);
        if (point + 1 >= plan.strain.size()) break;
        for (long k = 0; k < every; ++k) {
            if (k) e = evaluate(s, one.model, one.control, workspace);
            step(s, one.model, one.control, Scheme::heun, March::strain, plan.interval / every, e,
                 workspace);
        }
    }
    return {{"quantity", by_stress ? "shear_rate" : "shear_stress"},
            {"strain_interval", plan.interval},
            {"strain", plan.strain},
            {"value", value},
            {"contacts", contacts},
            {"time", time},
            {"step", plan.interval / every},
            {"final",
             {{"offset", s.box.offset},
              {"positions", array_of(s.position, [](const Vec3& x) { return list(x); })}}}};
}

std::string evaluate_case(const std::filesystem::path& path)
{
    const JsonDocument document = JsonDocument::read(path);
    const JsonNode root = document.root();
    Json result;
    switch (kind_of(root)) {
        case 0: {
            const Case one = read_case(root);
            result["expected"] = naming_the_file(path, [&] { return observables_json(one); });
            break;
        }
        case 1: {
            const Case one = read_case(root);
            const TrajectoryPlan plan = read_plan(root.member("expected"));
            result["expected"] = naming_the_file(path, [&] { return trajectory_json(one, plan); });
            break;
        }
        default:
            result["cases"] = array_of(read_pairs(root), [](const PairCase& pair) {
                return Json{{"expected", pair_case_json(pair)}};
            });
    }
    return result.dump(1) + "\n";
}

std::string describe_case(const JsonNode& root)
{
    const std::size_t kind = kind_of(root);
    if (kind == 2) return "case, " + std::to_string(read_pairs(root).size()) + " pairs";
    const Case one = read_case(root);
    const auto* stress = std::get_if<ImposedStress>(&one.control);
    std::string text = "case, " + std::to_string(one.state.size()) + " particles, imposed ";
    text += stress ? "stress " + number_text(stress->value)
                   : "rate " + number_text(std::get<ImposedRate>(one.control).value);
    if (kind == 0) return text;
    const TrajectoryPlan plan = read_plan(root.member("expected"));
    return text + ", trajectory to strain " + number_text(plan.strain.back());
}

void write_case(const std::filesystem::path& path, const State& state, const Model& model,
                const Control& control)
{
    Json json{{"kind", "instant"}};
    Model copy = model;
    Fields fields;
    describe(fields, copy);
    json["model"] = write_fields(fields.list());
    if (const auto* stress = std::get_if<ImposedStress>(&control))
        json["control"] = {{"stress", stress->value}};
    else
        json["control"] = {{"rate", std::get<ImposedRate>(control).value}};
    json["state"] = state_json(state);
    write_file(path, json.dump() + "\n");
}

}
