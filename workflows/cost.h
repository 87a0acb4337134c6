// workflows/cost.h -- how long the steps of a workflow will take.
//
// Shearing. Steps per unit strain, for the scheme "implicit" with displacement d = 0.01 a:
//   S = (n/500)^0.134 [156 + 11.8 w (phi_J - phi)^-1.59],   phi_J = 0.596 f + 0.685 (1 - f),
// f = exp(-1.25/stress) without units (sigma0): non-affine velocities, which limit a step, grow
// towards the jamming fraction of the share f of frictional contacts, as in M. Wyart and M. E.
// Cates, Phys. Rev. Lett. 112, 098302 (2014). Of spheres without friction f = 0. w, the mean of
// 1 - exp(-strain/0.15) over the run, is for the start from a packing without contacts. The five
// constants were fitted to 60 runs (n = 100 to 4500, phi = 0.3 to 0.57, stress 0.1 to 20): rms
// 7.6 %, at most 17 %. S goes with d^-0.98; "heun" and "euler" (d = 0.001 a): 7.5 to 13 S in 18
// runs. An imposed rate is taken for the stress rate (1 - phi/phi_J)^-2.
// Beyond phi_J a suspension jams, soon or late: the time is that of the whole strain at
// phi_J - phi = 0.01, "at most".
//
// A step takes n (1 + 0.6 n^2/(n^2 + 1500^2)) 2.5 us (heun 2.0, euler 1.25), a sample 0.9 of it,
// and half a step more because a step ends there. Frames need a direct solution: n 22 us +
// 92 ms (n/1000)^1.65 (phi/0.5)^2.63, as do the steps of the solver "cholesky"; a packing
// n (10 + 40 exp(15.7 (phi - 0.5))) us; pictures and analyses are rough. All that on the reference
// machine; `machine_factor` measures how much longer this one takes.
//
// "equilibrate" ends when the flow is stationary: taken for 1.5 of its minimum strain; steps that
// choose their runs themselves (adaptive_flow_curve, jamming) are rough.
// Predicted over taken: 0.72 to 1.34 for 12 of 13 runs (n = 100 to 4500, three schemes, rate
// control, no friction, quickstart.json) on a busy machine, one 2.24 while its speed changed: the
// table in tests/benchmarks/README.md, made by plan_table.py.
#pragma once
#include "workflows/workflow.h"

#include <string>
#include <vector>

namespace sigmaflow::workflows {

struct StepCost {
    std::string name;
    double seconds = 0;
    double at_most = 0;  // [s] where the length of the step is not known before; else the same
    bool jams = false;   // it may end early
};

/// Time of this machine over that of the reference, measured in less than a second of computing: a
/// packing of this suspension, of 1000 particles at most, and some steps from it.
double machine_factor(const Suspension& suspension);

/// One for each step. `threads`: of the run; only steps made of many runs are divided by it.
std::vector<StepCost> cost(const Workflow& workflow, double machine, int threads = 1);

}
