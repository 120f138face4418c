/* A scene as the user wrote it, validated, in SI units, with "auto" values unresolved. Pure data:
 * method, effects and memory are decided by plan.h. */
#ifndef TOSUI_SPHSOLVE_SCENE_SCENE_H
#define TOSUI_SPHSOLVE_SCENE_SCENE_H

#include <stdbool.h>
#include <stddef.h>

#include "common/error.h"
#include "common/kernel.h"

/* Defined in plan/method.h; only the names that a scene may use are needed here. */
struct method;
#define METHOD(name) extern const struct method method_##name;
#include "sphsolve/scene/methods.def"
#undef METHOD

extern const char *const scene_method_names[]; /* "auto" and those, ended by NULL */
extern const char *const scene_axis_names[];   /* x, y, z, ended by NULL */

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

/* Settings that later errors refer to with their line in the file. */
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
struct scene_place_name {
  const char *group, *key;
};
extern const struct scene_place_name scene_places[];

struct fluid {
  char name[64];
  double density;         /* kg/m^3 */
  double viscosity;       /* Pa s */
  double surface_tension; /* N/m; 0 without */
};

/* Cross-section of a prism, in the plane of two axes. */
struct polygon {
  int axis, plane[2]; /* axis of the prism; axes of the section's coordinates */
  size_t count;
  double (*corner)[2]; /* m, in order along the boundary */
};

struct stl;

/* Retention curve of variably saturated soil, van Genuchten's or Haverkamp's
 * (darcy/retention.h); the porosity is then theta_s. */
struct retention_curve {
  bool given;
  double alpha, n, theta_r, l; /* 1/m, -, -, - */
  double k_alpha, k_n;         /* 1/m, -: conductivity curve of Haverkamp; else 0 */
  bool exponential;            /* Gardner's curve, of which alpha and theta_r are those */
  enum soil_start starts_by;   /* meaning of `start`: a level, m; a pressure head, m; theta */
  double start;
};

/* Name of the curve in a scene. */
static inline const char *retention_name(const struct retention_curve *curve) {
  return curve->exponential ? "gardner" : curve->k_n > 0 ? "haverkamp" : "van_genuchten";
}

/* A function of time given as a table: linear between its times, constant before and after. */
struct time_table {
  size_t count;       /* 0: no table */
  double *time;       /* s, rising */
  double (*value)[3]; /* one number, or a vector */
};

struct region {
  enum region_type type;
  double box[6]; /* x0 y0 z0 x1 y1 z1, m; a 2-D scene uses x and z, y spans everything */
  int line;      /* in the scene file, for messages */
  size_t number; /* in the scene file, from 0 */
  /* A polygon is represented by the boxes it is cut into, regions [first, end) (scene_shapes.c);
   * for any other region `first` is its own index. */
  struct polygon *polygon; /* owned by region `first`; NULL: the region is a box */
  struct stl *stl;         /* surface of a body, of region `first` alone once it is cut */
  bool is_part;            /* without a polygon: a box of such a body */
  size_t first, end;
  double extent[6]; /* extent of the whole polygon or body, as `box` */
  /* porous */
  double porosity, grain_size, alpha, beta;
  bool anisotropic; /* the permeability depends on the direction */
  /* Permeability tensor (xx xy xz yy yz zz) divided by its geometric mean, which the drag uses; yy
   * = 1 in 2-D. */
  double anisotropy[6];
  double permeability; /* m/s, as given (mean if anisotropic); 0: from the grain size */
  struct retention_curve retention;
  double soil_velocity[3]; /* moving soil, m/s */
  bool saturated;          /* initially saturated also outside water regions */
  bool dry;                /* initially dry there, even if soil is saturated by default */
  char name[32];           /* "" for a wall whose force is not requested */
  /* wall */
  bool slip;
  double velocity[3]; /* m/s, prescribed velocity of a wall; initial velocity of water */
  /* inflow: fixed head (m above z = 0; for BOUNDARY_PRESSURE the pressure head) or flux (m/s
   * through the side, positive inward) */
  enum region_boundary boundary;
  double head, flux;
  bool radiates; /* it lets waves out: the head is that of the mean (isph/radiation.h) */
  /* A well extracts a rate from soil, m^3/s (m^2/s in 2-D); a drain extracts water above its head,
   * or without a head (BOUNDARY_NONE) above atmospheric pressure. Rain supplies a rate, m/s, to
   * what lies below. All three have a name. */
  double rate;
  double ponding; /* m; depth to which rain stands on unsaturated soil before it runs off */
  /* Head, flux, rate or wall velocity as a function of time; the members above then hold the values
   * of largest magnitude. */
  struct time_table table;
};

/* Whether water leaves by it within the soil or the water. */
static inline bool region_is_sink(const struct region *region) {
  return region->type == REGION_WELL || region->type == REGION_DRAIN;
}

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
  bool wants_slow_k;           /* --error or --time: the k of slow flow is asked for */
  double end_time;             /* s; INFINITY: not given, the run ends when it is steady */
  double steady_tolerance;     /* 0: runs to end_time */

  char model_path[4096]; /* "" when the scene has a domain */
  /* "" unless a solute is carried by a flow that is already solved; then only solute settings are
   * used below. */
  char flow_path[4096];

  int dimensions;         /* 2 or 3; a 2-D scene uses x and z */
  double domain_size[3];  /* m; y of a 2-D scene: one spacing */
  double spacing;         /* m; 0 when the model gives it */
  double lattice_spacing; /* m, of the sites in a model; NAN: auto, that of the voxels */
  bool periodic[3];

  struct fluid fluid;
  size_t region_count;
  struct region *regions;

  double gravity[3];           /* m/s^2 */
  double body_acceleration[3]; /* m/s^2 */
  double pressure_gradient[3]; /* Pa/m: imposed mean dP/dx; drives flow against it */
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
    double tolerance;       /* relative, of the pressure solver */
    bool slip;              /* outer and default walls */
    enum pressure_solver solver;
    double smagorinsky;  /* C_s */
    bool porosity_paper; /* porosity = "m15": smoothed by M15 eq. 32, else as in isph/soil.c */
  } isph;

  struct {            /* soil of the model with pores smaller than the voxel */
    int factor_count; /* k is also computed with its permeabilities times these; ascending */
    double factors[MICRO_FACTORS_MOST];
    double uncertainty; /* factor > 1 within which they are known (95 %); NAN: not given */
  } micro;

  struct {
    double diffusion; /* m^2/s, molecular; NAN: only ratios to it are computed */
    double length;    /* m, of the Peclet number; NAN: auto */
    int peclet_count; /* 0: only that of the given flow */
    double peclet[SOLUTE_PECLET_MAX];
    enum solute_way way;
    double error; /* requested relative error of a random walk (--error); NAN: auto */
  } solute;

  enum switch_state turbulence, shifting;

  double output_interval;    /* s; NAN: auto (recorder.c) */
  double history_interval;   /* s; NAN: auto */
  bool image;                /* the last state is written as an image */
  size_t output_field_count; /* output.fields; 0: all */
  char (*output_fields)[32];
  double checkpoint_interval; /* s of wall time; NAN: on a signal only */

  size_t gauge_count, plane_count;
  struct gauge *gauges;
  struct flux_plane *planes;

  char *text;                     /* text of the file with overrides, for /run/scene */
  int line_of[SCENE_PLACE_COUNT]; /* 0: not in the file */
};

void scene_free(struct scene *scene);

/* Returns an input error at a setting: "dense.cfg:7: wcsph.dt: MESSAGE". If the file omits the
 * setting, the line is that of its group, or else that of the group 'scene'. */
enum status scene_error(const struct scene *scene, enum scene_place place, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

bool scene_has_region(const struct scene *scene, enum region_type type);
/* |driving| / 9.80665 m/s^2, unless the scene says otherwise. */
double scene_hydraulic_gradient(const struct scene *scene);
/* Axis of the side of the domain that an inflow region lies on, -1 if none; *at_low: it is the
 * lower side. */
int scene_inflow_axis(const struct scene *scene, const struct region *region, bool *at_low);
/* Axis of the largest component of a vector; 0 for the zero vector. */
int scene_axis_along(const double vector[3]);

/* Mean of a region's table of time up to the end of the run; `steady` if it has none. */
double scene_mean_given(const struct scene *scene, const struct region *region, double steady);

/* Value at a time (s); `component` is 0 for scalars. */
double time_table_at(const struct time_table *table, double time, int component);
/* Exact integral from one time to a later one. */
double time_table_integral(const struct time_table *table, double from, double to, int component);
/* The value of largest magnitude. */
double time_table_extreme(const struct time_table *table, int component);

#endif
