#include "io/case_file.h"

#include "engine/error.h"
#include "engine/lubrication/pair_resistance.h"
#include "engine/step.h"
#include "io/atomic_file.h"
#include "io/model_fields.h"

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

Contact read_contact(const JsonNode& node, int particles)
{
    node.refuse_other_keys({"i", "j", "spring", "rolling", "sliding"});
    Contact c;
    c.i = static_cast<int>(node.member("i").integer(0, particles - 1));
    c.j = static_cast<int>(node.member("j").integer(0, particles - 1));
    if (c.i >= c.j) throw node.error("needs i < j");
    c.spring = node.member("spring").vector({}, "a");
    if (const auto rolling = node.find("rolling")) c.rolling = rolling->vector({}, "a");
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
    for (int row : one.pair_rows) {
        if (row >= static_cast<int>(e.pairs.size()))
            throw Error(ErrorKind::input, "/pair_rows",
                        "row " + std::to_string(row) + " of " + std::to_string(e.pairs.size()) +
                            " pairs in range");
        show(row);
    }
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

Json pair_case_json(const JsonNode& node)
{
    const double a = node.member("ai").number(above(0), "a");
    const double b = node.member("aj").number(above(0), "a");
    const auto [L, l] =
        lubrication::gap_factors(node.member("xi").number(), node.member("delta").number(above(0)));
    const auto r = lubrication::scaled(lubrication::pair_coefficients(a, b), L, l);
    const Vec3 n = node.member("normal").vector();
    const Mat3 E = node.member("E").matrix();
    const auto W = node.member("W").elements(Length::exactly(2));
    std::array<Vec6, 2> w;
    for (int k = 0; k < 2; ++k) w[k] = Vec6(W[k].numbers(Length::exactly(6)).data());

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
    const auto su = lubrication::velocity_stresslet(r, n, w[0], w[1]);
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
    TrajectoryPlan plan;
    plan.strain = expected.member("strain").numbers({.minimum = 1}, at_least(0));
    plan.interval = expected.member("strain_interval").number(above(0));
    // half the coarse step: its error is stated in the files
    plan.step = plan.interval / 100;
    if (const auto coarse = expected.find("coarse_step")) plan.step = coarse->number(above(0)) / 2;
    return plan;
}

}

State read_state(const JsonNode& node)
{
    node.refuse_other_keys({"box", "offset", "positions", "radii", "contacts"});
    State s;
    s.box.length = node.member("box").vector(above(0), "a");
    s.box.offset = node.member("offset").number({}, "a");
    s.radius = node.member("radii").numbers({.minimum = 1}, above(0), "a");
    s.position = node.member("positions").vectors(Length::exactly(s.radius.size()), {}, "a");
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
    if (const auto rows = root.find("pair_rows"))
        for (const JsonNode& row : rows->elements())
            one.pair_rows.push_back(static_cast<int>(row.integer(0, 1000000000)));
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
    const std::size_t kind = root.member("kind").word({"instant", "trajectory", "pairs"});
    Json result;
    try {
        if (kind == 2)
            result["cases"] = array_of(root.member("cases").elements(), [](const JsonNode& node) {
                return Json{{"expected", pair_case_json(node)}};
            });
        else if (kind == 1)
            result["expected"] =
                trajectory_json(read_case(root), read_plan(root.member("expected")));
        else
            result["expected"] = observables_json(read_case(root));
    } catch (const Error& error) {
        // errors of the reader name the file already
        if (error.where().starts_with(path.string())) throw;
        throw error.within(path.string());
    }
    return result.dump(1) + "\n";
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
