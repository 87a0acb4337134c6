// render/offscreen.cpp
//
// How the window works: a vtkGenericOpenGLRenderWindow that owns an OpenGL 3.2 core context with a
// tiny pbuffer. VTK draws into framebuffers of its own, from which pictures are read; the pbuffer
// only has to exist.
#include <GL/glew.h>

#include "engine/error.h"
#include "render/egl_library.h"
#include "render/offscreen.h"

#include <vtkGenericOpenGLRenderWindow.h>
#include <vtkObjectFactory.h>
#include <vtkOutputWindow.h>
#include <vtkRenderer.h>
#include <vtkRendererCollection.h>
#include <vtkUnsignedCharArray.h>
#include <vtkVersion.h>

namespace sigmaflow::render {
namespace {

class EglRenderWindow : public vtkGenericOpenGLRenderWindow {
public:
    static EglRenderWindow* New();
    vtkTypeMacro(EglRenderWindow, vtkGenericOpenGLRenderWindow);

    void create_context();

    void Initialize() override;
    void Render() override;
    void Finalize() override;
    void MakeCurrent() override;
    bool IsCurrent() override;
    int SupportsOpenGL() override { return 1; }
    vtkTypeBool IsDirect() override { return 1; }
    void OpenGLInitContext() override;

protected:
    EglRenderWindow();
    ~EglRenderWindow() override;

private:
    const EglLibrary* egl_ = nullptr;  // null until there is a context
    EGLContext context_ = EGL_NO_CONTEXT;
    EGLSurface surface_ = EGL_NO_SURFACE;
};

vtkStandardNewMacro(EglRenderWindow);

EglRenderWindow::EglRenderWindow()
{
    SetOffScreenRendering(1);
    FrameBlitMode = NoBlit;  // pictures are read from VTK's own framebuffers
    OwnContext = 1;
    Mapped = 1;
    ReadyForRendering = true;
}

EglRenderWindow::~EglRenderWindow()
{
    Finalize();
    vtkCollectionSimpleIterator position;
    Renderers->InitTraversal(position);
    while (vtkRenderer* renderer = Renderers->GetNextRenderer(position))
        renderer->SetRenderWindow(nullptr);
}

Error cannot_draw(const std::string& problem)
{
    return Error(ErrorKind::rendering, "off-screen window",
                 problem + "; OpenGL 3.2 is needed: install the package libgl1-mesa-dri");
}

void EglRenderWindow::create_context()
{
    if (context_ != EGL_NO_CONTEXT) return;
    const EglLibrary& egl = egl_library();
    const EGLint version[] = {EGL_CONTEXT_MAJOR_VERSION,
                              3,
                              EGL_CONTEXT_MINOR_VERSION,
                              2,
                              EGL_CONTEXT_OPENGL_PROFILE_MASK,
                              EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                              EGL_NONE};
    const EGLint size[] = {EGL_WIDTH, 8, EGL_HEIGHT, 8, EGL_NONE};
    if (!egl.bind_api(EGL_OPENGL_API)) throw cannot_draw("EGL knows no desktop OpenGL");
    context_ = egl.create_context(egl.display, egl.config, EGL_NO_CONTEXT, version);
    if (context_ == EGL_NO_CONTEXT) throw cannot_draw("no OpenGL context can be created");
    surface_ = egl.create_pbuffer_surface(egl.display, egl.config, size);
    egl_ = &egl;
    MakeCurrent();
    if (!IsCurrent()) throw cannot_draw("the OpenGL context cannot be used");
    OpenGLInit();
    if (!Initialized) throw cannot_draw("the OpenGL functions cannot be loaded");
}

void EglRenderWindow::MakeCurrent()
{
    if (!egl_ || IsCurrent()) return;
    egl_->bind_api(EGL_OPENGL_API);
    egl_->make_current(egl_->display, surface_, surface_, context_);
}

bool EglRenderWindow::IsCurrent()
{
    return egl_ && egl_->get_current_context() == context_;
}

/// VTK calls this for windows that others made through vtkRenderWindow::New(). It cannot pass an
/// exception through VTK, so a window without a context is marked as not ready and draws nothing.
void EglRenderWindow::Initialize()
{
    try {
        create_context();
    } catch (const Error& error) {
        ReadyForRendering = false;
        vtkErrorMacro(<< error.what());
    }
}

void EglRenderWindow::Render()
{
    Initialize();
    if (ReadyForRendering) Superclass::Render();
}

void EglRenderWindow::OpenGLInitContext()
{
    ContextCreationTime.Modified();
    if (Initialized) return;
    MakeCurrent();
    glewExperimental = GL_TRUE;
    // Debian's GLEW loads the OpenGL functions first and then asks for an X display. There is none,
    // so its last complaint is harmless.
    const GLenum result = glewInit();
    GlewInitValid = (result == GLEW_OK || result == GLEW_ERROR_NO_GLX_DISPLAY) && GLEW_VERSION_3_2;
    while (glGetError() != GL_NO_ERROR) {
    }
    if (!GlewInitValid) return;
    Initialized = true;
    GLfloat width[2] = {1, 1};
    glGetFloatv(GL_ALIASED_LINE_WIDTH_RANGE, width);
    MaximumHardwareLineWidth = width[1];
}

void EglRenderWindow::Finalize()
{
    if (!egl_) return;
    MakeCurrent();
    Superclass::Finalize();  // frees what VTK keeps on the graphics side
    egl_->make_current(egl_->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    if (surface_ != EGL_NO_SURFACE) egl_->destroy_surface(egl_->display, surface_);
    egl_->destroy_context(egl_->display, context_);
    egl_ = nullptr;
    context_ = EGL_NO_CONTEXT;
    surface_ = EGL_NO_SURFACE;
    Initialized = false;
}

VTK_CREATE_CREATE_FUNCTION(EglRenderWindow);

class EglFactory : public vtkObjectFactory {
public:
    static EglFactory* New();
    vtkTypeMacro(EglFactory, vtkObjectFactory);
    const char* GetVTKSourceVersion() override { return VTK_SOURCE_VERSION; }
    const char* GetDescription() override { return "off-screen EGL window"; }

protected:
    EglFactory()
    {
        RegisterOverride("vtkRenderWindow", "EglRenderWindow", "off-screen EGL window", 1,
                         vtkObjectFactoryCreateEglRenderWindow);
    }
};
vtkStandardNewMacro(EglFactory);

bool registered_as_default()
{
    vtkObjectFactory::SetAllEnableFlags(0, "vtkRenderWindow");  // the X window
    vtkObjectFactory::RegisterFactory(vtkSmartPointer<EglFactory>::New());
    return true;
}

}

vtkSmartPointer<vtkRenderWindow> make_offscreen_window(int width, int height)
{
    static const bool once = registered_as_default();
    (void)once;
    auto window = vtkSmartPointer<EglRenderWindow>::New();
    window->SetSize(width, height);
    window->SetMultiSamples(0);
    window->create_context();
    return window;
}

vtkSmartPointer<vtkRenderWindow> KeptWindow::of_size(int width, int height)
{
    if (!window_ || window_->GetSize()[0] != width || window_->GetSize()[1] != height)
        window_ = make_offscreen_window(width, height);
    return window_;
}

Image read_pixels(vtkRenderWindow* window)
{
    const int* size = window->GetSize();
    Image image(size[0], size[1]);
    auto bytes = vtkSmartPointer<vtkUnsignedCharArray>::New();
    window->GetPixelData(0, 0, image.width - 1, image.height - 1, 0, bytes);
    if (bytes->GetNumberOfValues() != static_cast<vtkIdType>(image.rgb.size()))
        throw cannot_draw("the picture cannot be read back");
    for (int row = 0; row < image.height; ++row) {  // OpenGL's first row is at the bottom
        const unsigned char* source = bytes->GetPointer(3 * vtkIdType(row) * image.width);
        std::copy(source, source + 3 * image.width, image.pixel(0, image.height - 1 - row));
    }
    return image;
}

class VtkMessages::Collector : public vtkOutputWindow {
public:
    static Collector* New();
    vtkTypeMacro(Collector, vtkOutputWindow);
    void DisplayText(const char*) override {}
    void DisplayErrorText(const char* text) override
    {
        if (first_error.empty()) first_error = text;
    }
    void DisplayWarningText(const char*) override {}
    void DisplayGenericWarningText(const char*) override {}
    void DisplayDebugText(const char*) override {}

    std::string first_error;
};
vtkStandardNewMacro(VtkMessages::Collector);

VtkMessages::VtkMessages()
    : collector_(vtkSmartPointer<Collector>::New()), previous_(vtkOutputWindow::GetInstance())
{
    vtkOutputWindow::SetInstance(collector_);
}

VtkMessages::~VtkMessages()
{
    vtkOutputWindow::SetInstance(previous_);
}

void VtkMessages::throw_if_error() const
{
    if (collector_->first_error.empty()) return;
    std::string text = collector_->first_error;
    for (char& letter : text)
        if (letter == '\n') letter = ' ';
    throw Error(ErrorKind::rendering, "vtk", text.substr(0, text.find_last_not_of(' ') + 1));
}

std::string why_unavailable()
{
    try {
        const VtkMessages messages;
        const auto window = make_offscreen_window(16, 16);
        const auto renderer = vtkSmartPointer<vtkRenderer>::New();
        renderer->SetBackground(1.0, 0.0, 0.2);  // = (255, 0, 51)
        window->AddRenderer(renderer);
        window->Render();
        messages.throw_if_error();
        const Image image = read_pixels(window);
        const std::uint8_t* pixel = image.pixel(8, 8);
        if (pixel[0] < 250 || pixel[1] > 5 || pixel[2] < 46 || pixel[2] > 56)
            return "the graphics driver draws a wrong colour; install the package libgl1-mesa-dri";
    } catch (const std::exception& error) {
        return error.what();
    }
    return {};
}

}
