/* A scene as the user wrote it, validated, in SI, with "auto" still auto. Pure data: no method, no
 * effect and no memory size is decided here (plan.h does). */
#ifndef TOSUI_SPHSOLVE_SCENE_SCENE_H
#define TOSUI_SPHSOLVE_SCENE_SCENE_H

#include <stdbool.h>
#include <stddef.h>

#include "common/error.h"
#include "common/kernel.h"
#include "sphsolve/scene/time_table.h"

/* plan/method.h; here only what a scene may name. */
struct method;
#define METHOD(name) extern const struct method method_##name;
#include "sphsolve/scene/methods.def"
#undef METHOD

enum wall_scheme { WALL_FROZEN, WALL_ADAMI, WALL_SUBVOXEL };
extern const char *const wall_scheme_names[]; /* as a scene writes them, ended by NULL */
enum equation_of_state { EOS_GAUGE, EOS_ABSOLUTE };
enum unified_form { FORM_AKBARI, FORM_M15 };
enum pressure_solver { SOLVER_GRID, SOLVER_PETSC };
enum switch_state { SWITCH_AUTO, SWITCH_ON, SWITCH_OFF };
enum region_type {
  REGION_WATER,
  REGION_POROUS,
  REGION_WALL,
  REGION_INFLOW,
  REGION_EMPTY,
  REGION_WELL,
  REGION_DRAIN,
  REGION_RAIN,
  REGION_ABSORBING
};
extern const char *const region_type_names[]; /* as a scene writes them, ended by NULL */
enum solute_way { SOLUTE_CLOSURE, SOLUTE_WALK, SOLUTE_BOTH };
extern const char *const solute_way_names[];
#define SOLUTE_PECLET_MAX 64
#define MICRO_FACTORS_MOST 32
enum region_boundary { BOUNDARY_NONE, BOUNDARY_HEAD, BOUNDARY_FLUX, BOUNDARY_PRESSURE };
enum soil_start { START_HEAD, START_PRESSURE, START_WATER };

/* Settings that errors found after reading name with their line. */
#define SCENE_PLACES(X)                                                                            \
  X(METHOD, "scene", "method")                                                                     \
  X(MODEL, "model", "file")                                                                        \
  X(FLOW, "flow", "file")                                                                          \
  X(SOLUTE, "solute", "")                                                                          \
  X(LATTICE, "lattice", "spacing")                                                                 \
  X(SIZE, "domain", "size")                                                                        \
  X(SPACING, "domain", "spacing")                                                                  \
  X(PERIODIC, "domain", "periodic")                                                                \
  X(VISCOSITY, "fluids", "")                                                                       \
  X(REGIONS, "regions", "")                                                                        \
  X(FORCE, "force", "")                                                                            \
  X(WCSPH_KERNEL, "wcsph", "kernel")                                                               \
  X(WCSPH_SUPPORT, "wcsph", "support")                                                             \
  X(SOUND, "wcsph", "sound_speed")                                                                 \
  X(WCSPH_DT, "wcsph", "dt")                                                                       \
  X(STOKES_SUPPORT, "stokes", "support")                                                           \
  X(ISPH_DT, "isph", "dt")                                                                         \
  X(TURBULENCE, "effects", "turbulence")                                                           \
  X(SHIFTING, "effects", "shifting")                                                               \
  X(MICRO, "micro", "")                                                                            \
  X(MICRO_FACTORS, "micro", "factors")                                                             \
  X(FIELDS, "output", "fields")
enum scene_place {
#define X(symbol, group, key) AT_##symbol,
  SCENE_PLACES(X)
#undef X
      SCENE_PLACE_COUNT
};

struct fluid {
  char name[64];
  double density;         /* kg/m^3 */
  double viscosity;       /* Pa s */
  double surface_tension; /* N/m; 0 without */
};

/* A prism's section, in the plane of two axes. */
struct polygon {
  int axis, plane[2]; /* of the prism; of its section's coordinates */
  size_t count;
  double (*corner)[2]; /* m, in order round it */
};

struct stl;

/* The curve of soil that need not be full of water, van Genuchten's or Haverkamp's
 * (richards/retention.h); porosity is theta_s then. */
struct retention_curve {
  bool given;
  double alpha, n, theta_r, l; /* 1/m, -, -, - */
  double k_alpha, k_n;         /* 1/m, -: of Haverkamp's curves, by which k is its own; else 0 */
  enum soil_start starts_by;   /* what `start` is: a level, m; a pressure head, m; theta */
  double start;
};

/* As a scene calls it. */
static inline const char *retention_name(const struct retention_curve *curve) {
  return curve->k_n > 0 ? "haverkamp" : "van_genuchten";
}

struct region {
  enum region_type type;
  double box[6]; /* x0 y0 z0 x1 y1 z1, m; a 2-D scene uses x and z, y spans everything */
  int line;      /* in the scene file, for messages */
  size_t number; /* in the scene file, from 0 */
  /* A polygon stands as the boxes it is cut into, regions [first, end) (scene_shapes.c); any other
   * region is its own first. */
  struct polygon *polygon; /* owned by the first; NULL: the region is a box */
  struct stl *stl;         /* of a body within a surface, until it is cut (scene_stl.c) */
  bool is_part;            /* without a polygon: of such a body */
  size_t first, end;
  double extent[6]; /* of the whole, as `box` */
  /* porous */
  double porosity, grain_size, alpha, beta;
  bool anisotropic;        /* permeable along one axis more than along another */
  double anisotropy[6];    /* then its permeability (xx xy xz yy yz zz) over that of the drag, the
                              geometric mean; yy = 1 in 2-D */
  double permeability;     /* m/s, as the scene gives it (of beds the mean); 0: by the grain size */
  struct retention_curve retention;
  double soil_velocity[3]; /* moving soil, m/s */
  bool saturated;          /* full of water at the start also where no water region covers it */
  bool dry;                /* dry there, even where soil would start full by itself */
  char name[32];           /* of a wall "" unless its force is asked for */
  /* wall */
  bool slip;
  double velocity[3]; /* m/s, prescribed velocity of a wall; initial velocity of water */
  /* inflow: fixed head (m above z = 0, or, BOUNDARY_PRESSURE, of pressure) or flux (m/s through the
     side, positive inward) */
  enum region_boundary boundary;
  double head, flux;
  /* A well takes a rate out of soil, m^3/s (m^2/s in 2-D); a drain what holds its head, or without
     one (boundary none) the pressure of the air. Rain brings a rate, m/s, onto what lies below. All
     three have a name. */
  double rate;
  /* head, flux, rate or a wall's velocity in time; those above then hold the values of largest size
   */
  struct time_table table;
};

struct gauge {
  char name[32];
  double at[3]; /* m */
};
struct flux_plane {
  char name[32];
  int axis; /* normal */
  double position;
};

struct scene {
  char path[4096];
  char name[128];
  const struct method *method; /* NULL: auto */
  double end_time;             /* s; INFINITY: not given, the run ends when it is steady */
  double steady_tolerance;     /* 0: runs to end_time */

  char model_path[4096]; /* "" when the scene has a domain */
  char flow_path[4096];  /* "" unless it carries a solute through a flow that is solved already:
                            then nothing but solute stands below */

  int dimensions;         /* 2 or 3; a 2-D scene lives in x and z */
  double domain_size[3];  /* m; y of a 2-D scene: one spacing */
  double spacing;         /* m; 0 when the model gives it */
  double lattice_spacing; /* m, of the sites in a model; NAN: auto, the model's voxels */
  bool periodic[3];

  struct fluid fluid;
  size_t region_count;
  struct region *regions;

  double gravity[3];           /* m/s^2 */
  double body_acceleration[3]; /* m/s^2 */
  double pressure_gradient[3]; /* Pa/m: imposed mean dP/dx; drives flow along minus itself */
  double hydraulic_gradient;   /* NAN: |body acceleration| / 9.80665 */
  double driving[3];           /* m/s^2: g + a - grad P / rho */

  struct {
    double sound_speed; /* m/s; NAN: auto */
    enum equation_of_state equation_of_state;
    enum kernel kernel;
    double support; /* m; NAN: auto (2.9 spacings) */
    double dt;      /* s; NAN: auto */
    bool force_dt;  /* a dt beyond the limit is accepted */
    enum wall_scheme wall;
  } wcsph;
  struct {
    enum kernel kernel;
    double support; /* m; NAN: auto */
    enum wall_scheme wall;
    double tolerance; /* relative residual */
  } stokes;
  struct {
    enum unified_form form;
    enum kernel kernel;
    double support_ratio;   /* he / dx */
    double relaxation_time; /* s: tau of the density relaxation, where alpha is NAN */
    double alpha;           /* tau = dt / alpha; 0: no relaxation; NAN: not given */
    double dt;              /* s; NAN: auto */
    double tolerance;       /* of the pressure solve */
    bool slip;              /* outer and default walls */
    enum pressure_solver solver;
    double smagorinsky;  /* C_s */
    bool porosity_paper; /* porosity = "m15": smoothed by M15 eq. 32, else as isph/soil.c says */
  } isph;

  struct {            /* soil of the model with pores below the voxel */
    int factor_count; /* k is solved with its permeabilities times these, too; ascending */
    double factors[MICRO_FACTORS_MOST];
    double uncertainty; /* factor, above 1, within which they are known (95 %); NAN: not given */
  } micro;

  struct {
    double diffusion; /* m^2/s, molecular; NAN: only ratios to it are asked for */
    double length;    /* m, of the Peclet number; NAN: auto */
    int peclet_count; /* 0: that of the flow as it is */
    double peclet[SOLUTE_PECLET_MAX];
    enum solute_way way;
    double error; /* wanted of a walk, relative (--error); NAN: auto */
  } solute;

  enum switch_state turbulence, shifting;

  double output_interval;    /* s; NAN: only the last snapshot */
  double history_interval;   /* s; NAN: auto */
  bool no_image;             /* output.image = false */
  size_t output_field_count; /* output.fields; 0: all */
  char (*output_fields)[32];
  double checkpoint_interval; /* s of wall time; NAN: on a signal only */

  size_t gauge_count, plane_count;
  struct gauge *gauges;
  struct flux_plane *planes;

  char *text;                     /* the file with overrides, for /run/scene */
  int line_of[SCENE_PLACE_COUNT]; /* 0: not in the file */
};

/* Reads and validates. Errors name file, line and what to do. Free with scene_free. */
enum status scene_read(const char *path, const char *const *overrides, size_t override_count,
                       struct scene *scene);
void scene_free(struct scene *scene);

/* An input error at a setting: "dense.cfg:7: wcsph.dt: MESSAGE". What the file leaves out is said
 * to be wrong where its group stands, else where the scene's name does. */
enum status scene_error(const struct scene *scene, enum scene_place place, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* |driving| / 9.80665 m/s^2, unless the scene says otherwise. */
double scene_hydraulic_gradient(const struct scene *scene);
/* The axis of the side of the domain that an inflow region lies on, -1: none; *at_low: the lower.
 */
int scene_inflow_axis(const struct scene *scene, const struct region *region, bool *at_low);
/* The axis along which most of a vector lies; 0 of none. */
int scene_axis_along(const double vector[3]);

#endif
