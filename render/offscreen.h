// render/offscreen.h -- the one place that knows how a picture gets its OpenGL context.
//
// Debian's VTK 9.1 is built for X windows only: without a display it aborts the process. The window
// here lives on an EGL context (Mesa's surfaceless platform, else the first EGL device that works),
// so it needs no X server, no environment variable and no side process. libEGL is loaded at run
// time: a machine without it loses its pictures, not the program.
//
// Use it from one thread at a time.
#pragma once
#include "render/image.h"

#include <vtkSmartPointer.h>
#include <string>

class vtkOutputWindow;
class vtkRenderWindow;

namespace sigmaflow::render {

/// A window of the given size [pixels] whose context works. From the first call on it is also what
/// vtkRenderWindow::New() returns in this process. Error: rendering, with the package to install.
vtkSmartPointer<vtkRenderWindow> make_offscreen_window(int width, int height);

/// The same window for one picture after another, as long as they have one size.
class KeptWindow {
public:
    vtkSmartPointer<vtkRenderWindow> of_size(int width, int height);

private:
    vtkSmartPointer<vtkRenderWindow> window_;
};

/// What the window shows after Render().
Image read_pixels(vtkRenderWindow* window);

/// While it lives, VTK prints nothing; its error messages are collected instead.
class VtkMessages {
public:
    VtkMessages();
    ~VtkMessages();
    VtkMessages(const VtkMessages&) = delete;
    VtkMessages& operator=(const VtkMessages&) = delete;

    /// Throws Error of kind rendering if VTK has reported an error.
    void throw_if_error() const;

private:
    class Collector;
    vtkSmartPointer<Collector> collector_;
    vtkSmartPointer<vtkOutputWindow> previous_;
};

}
