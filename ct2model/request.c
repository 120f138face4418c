#include "ct2model/request.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/output_guard.h"

/* By their places in COMMANDS. */
enum { SURVEY = 1u << 0, SWEEP = 1u << 1, BUILD = 1u << 2, INFO = 1u << 3, EXPORT = 1u << 4 };

static const struct option_command COMMANDS[] = {
    {"survey", "SLICES... [--void-ratio E] [options] -o page.html",
     "a page to look at before a model is made: slices, histogram, void ratio by the threshold",
     "ct2model survey slices/ --void-ratio 0.725 --voxel-size 5.83um -o page.html", 1, -1},
    {"sweep", "SLICES... --void-ratio E [options] [-o sweep.csv]",
     "grey threshold versus void ratio",
     "ct2model sweep slices/ --void-ratio 0.725 --voxel-size 5.83um --size 60x60x31 -o sweep.csv",
     1, -1},
    {"build", "SLICES... --void-ratio E [options] -o model.hdf",
     "calibrated, binarised, mirrored model",
     "ct2model build slices/ --void-ratio 0.725 --voxel-size 5.83um --crop 0,0,0,480,480,248 \\\n"
     "    --size 60x60x31 -o model.hdf",
     1, -1},
    {"info", "FILE...", "what a stack or a model holds, fast", "ct2model info slices/ model.hdf", 1,
     -1},
    {"export", "MODEL.hdf -o STACK.tif|PROFILE.csv",
     "a model as a TIFF stack, for Fiji (255 grain, 0 pore), or its porosity and pore widths by "
     "layer as CSV",
     "ct2model export model.hdf -o profile.csv", 1, 1},
    {0},
};

static const struct option_entry ENTRIES[] = {
    {"void-ratio", 'e', "E", SURVEY | SWEEP | BUILD,
     "measured void ratio, pore volume / grain volume; 0.725 or 0.725+-0.005; several, 0.7,0.75: a "
     "threshold, or a model (model-e0.75.hdf), for each"},
    {"output", 'o', "FILE", SURVEY | SWEEP | BUILD | EXPORT,
     "where the page (survey), the table (sweep), the model (build) or the stack (export) goes"},
    {"voxel-size", 0, "Q", SURVEY | SWEEP | BUILD | INFO,
     "edge of a voxel, e.g. 5.83um, or of x, y and z: 5um,5um,10um (needed unless the file says "
     "it)"},
    {"raw", 0, "NXxNYxNZ:TYPE[:BYTES]", SURVEY | SWEEP | BUILD | INFO,
     "headerless pixels: u8 i8 u16le u16be i16le i16be u32le u32be i32le i32be f32le f32be f64le "
     "f64be; BYTES: length of what each file begins with and no reader knows"},
    {"crop", 0, "auto|BOX", SURVEY | SWEEP | BUILD,
     "X0,Y0,Z0,NX,NY,NZ: use these voxels only; auto: the largest box in the specimen"},
    {"roi", 0, "SHAPE", SURVEY | SWEEP | BUILD,
     "where the void ratio was measured: box:X0,Y0,Z0,NX,NY,NZ, cylinder:CX,CY,R or mask:PATH"},
    {"size", 0, "NXxNYxNZ", SWEEP | BUILD, "voxels after resampling, before mirroring"},
    {"levels", 0, "N", BUILD,
     "models in all, 1 to 5: that of --size, and coarser ones (1/1.5, 1/2, 1/3, 1/4 of the voxels "
     "a "
     "side), as model-NX.hdf"},
    {"filter", 0, "bicubic|bicubic-point|area|none", SWEEP | BUILD,
     "how the voxels of --size are made (default bicubic, antialiased)"},
    {"mirror", 0, "x|y|z|none", SWEEP | BUILD,
     "axis of the model along which n layers become 2n-1, so that it is periodic (default z)"},
    {"sides", 0, "periodic|closed|mirrored", SWEEP | BUILD,
     "the faces along the flow: closed (walls, as in a tube), mirrored (in all axes; pores fit, as "
     "in "
     "a larger sample), or periodic: the sample again (default; given, it states that the image "
     "repeats itself, and k has no error by its sides)"},
    {"flow", 0, "x|y|z", SWEEP | BUILD,
     "axis of the scan that becomes the model's z (default z): x gives y,z,x, y gives z,x,y"},
    {"threshold", 0, "auto|otsu|VALUE", SURVEY | SWEEP | BUILD,
     "auto (match the void ratio, default), otsu, or a grey value"},
    {"segmented", 0, "[0|1|LABEL=pore|grain|soil(N,K),...]", SWEEP | BUILD,
     "an image of labels: which is pore (the rest grain), or what each is; found out where it "
     "holds two. soil: pores below the voxel, porosity N, permeability K (1e-15 m^2) or grain "
     "size"},
    {"micro", 0, "auto|LOW..HIGH|GREY:N,...", BUILD,
     "greys of soil with pores below the voxel: auto finds them, halfway between the peaks of "
     "pore, soil and grain; porosity N linear between the peaks of pore and grain, or as given"},
    {"micro-permeability", 0, "Q", BUILD,
     "of that soil: a permeability, as 1e-15m^2, or its grain size, as 2um (Kozeny, Carman)"},
    {"grain", 0, "bright|dark", SURVEY | SWEEP | BUILD, "which greys are grain (default bright)"},
    {"denoise", 0, "none|median|nlm", SURVEY | SWEEP | BUILD,
     "filter each slice by itself (in 2-D) first: none (default), median (5x5), nlm (non-local "
     "means)"},
    {"blur", 0, "remove|keep", BUILD,
     "what the scanner did to the surface: remove (default, where it can be measured) or keep"},
    {"correct", 0, "beam|rings|beam,rings", SURVEY | SWEEP | BUILD,
     "level what the radius does to the greys: beam (hardening), rings, or beam,rings"},
    {"axis", 0, "X,Y", SURVEY | SWEEP | BUILD, "pixel about which rings lie (default the middle)"},
    {"islands", 0, "keep|fill", SWEEP | BUILD,
     "pores that are not on the flow path: keep (default) or fill with grain"},
    {"scale-peak", 0, "VALUE", SURVEY | SWEEP | BUILD,
     "report greys scaled so that the grain peak is VALUE"},
    {0},
};

const struct option_table ct2model_options = {"ct2model", "CT slices to a calibrated voxel model",
                                              COMMANDS, ENTRIES};

static enum status parse_numbers(const struct options *options, const char *name, char separator,
                                 int count, const char *example, size_t *values) {
  long long numbers[6];
  if (!options_given(options, name)) return STATUS_OK;
  enum status status = options_integers(options, name, separator, count, numbers);
  if (status != STATUS_OK) return status;
  for (int i = 0; i < count; i++) {
    bool origin = count == 6 && i < 3;
    if (numbers[i] < (origin ? 0 : 1) || numbers[i] > 1000000)
      return FAIL(STATUS_USAGE, "--%s %s: %lld is out of range; write it like %s", name,
                  options_text(options, name), numbers[i], example);
    values[i] = (size_t)numbers[i];
  }
  return STATUS_OK;
}

/* Parses one edge for all axes, or one for each. No scanner resolves less than a nanometre, and no
 * scan of soil has voxels of a centimetre: such a length has the wrong unit. */
static enum status parse_voxel_size(const struct options *options, struct request *request) {
  const char *text = options_text(options, "voxel-size"), *at = text;
  const size_t digits = text != NULL ? strspn(text, "0123456789") : 0;
  if (digits > 0 && text[digits] == ',' && strspn(text + digits + 1, "0123456789") > 0)
    return FAIL(STATUS_USAGE,
                "--voxel-size %s: a decimal comma? Numbers take a point, as 8.745um; three lengths "
                "a unit each, as 5um,5um,10um",
                text);
  for (int d = 0; d < 3; d++) request->voxel[d] = NAN;
  if (text == NULL) return STATUS_OK;
  char part[64];
  int n = 0;
  for (bool more = true; more; n++) {
    const size_t length = strcspn(at, ",");
    more = at[length] == ',';
    if (n == 3 || length >= sizeof part) break;
    snprintf(part, sizeof part, "%.*s", (int)length, at);
    if (quantity_parse(part, DIM_LENGTH, &request->voxel[n]) != STATUS_OK)
      return error_context(STATUS_USAGE, "--voxel-size %s", text);
    if (!(request->voxel[n] >= 1e-9 && request->voxel[n] <= 0.01))
      return FAIL(STATUS_USAGE,
                  "--voxel-size %s: '%s' is no voxel of a scan, which has 1 nm to 1 cm; is 5.83um "
                  "meant, or 5.83mm?",
                  text, part);
    at += length + 1;
  }
  if (n != 1 && n != 3)
    return FAIL(STATUS_USAGE, "--voxel-size %s: one length is wanted, or three as 5um,5um,10um",
                text);
  request->has_slice_distance = n == 3;
  if (n == 1) request->voxel[1] = request->voxel[2] = request->voxel[0];
  return STATUS_OK;
}

/* Parses "0.725", "0.725+-0.005" or "0.725\u00b10.005". */
static enum status parse_one_void_ratio(const char *text, double *value, double *error) {
  char *end;
  *error = NAN;
  *value = strtod(text, &end);
  bool good = end != text && *value > 0.0 && isfinite(*value);
  if (good && *value > 30.0) { /* fibres and peat reach 20 */
    char percent[60] = "";
    if (*value < 100.0)
      snprintf(percent, sizeof percent, ", so %g %% is e = %.4g", *value,
               *value / (100.0 - *value));
    return FAIL(STATUS_USAGE,
                "--void-ratio %s: that would be a porosity of %.4g %%; a void ratio is pore volume "
                "/ grain volume, a porosity n is e = n / (1 - n)%s",
                text, 100.0 * *value / (1.0 + *value), percent);
  }
  size_t sign = strncmp(end, "+-", 2) == 0 || strncmp(end, "\xC2\xB1", 2) == 0 ? 2
                : strncmp(end, "+/-", 3) == 0                                  ? 3
                                                                               : 0;
  if (good && sign > 0) {
    const char *after = end + sign;
    *error = strtod(after, &end);
    good = end != after && *error >= 0.0;
    if (good && *end == '\0' && !(*error < *value))
      return FAIL(STATUS_USAGE,
                  "--void-ratio %s: an uncertainty of %g is as large as the void ratio itself; "
                  "it is absolute, e.g. 0.725+-0.005",
                  text, *error);
  }
  if (good && *end == '\0') return STATUS_OK;
  return FAIL(STATUS_USAGE,
              "--void-ratio %s: pore volume / grain volume is wanted, e.g. 0.725 (with a point) or "
              "0.725+-0.005 (porosity n is e = n / (1 - n)), or several as 0.7,0.75",
              text);
}

/* Parses one void ratio, or several separated by commas. */
static enum status parse_void_ratio(const struct options *options, struct request *request) {
  enum status status = STATUS_OK;
  const char *at = options_text(options, "void-ratio");
  const char *comma = at != NULL ? strchr(at, ',') : NULL;
  if (comma != NULL && strchr(at, '.') == NULL && comma[1] != '\0')
    TRY_FAIL(STATUS_USAGE,
             "--void-ratio %s: a decimal comma? Numbers take a point, as 0.725; several whole void "
             "ratios one as well, as 1.0,2.0",
             at);
  for (bool more = at != NULL; more;) {
    char part[64];
    const size_t length = strcspn(at, ","), n = request->void_ratio_count;
    more = at[length] == ',';
    if (n == VOID_RATIOS_MOST || length >= sizeof part)
      TRY_FAIL(STATUS_USAGE, "--void-ratio %s: %d values are possible", at, VOID_RATIOS_MOST);
    snprintf(part, sizeof part, "%.*s", (int)length, at);
    TRY(parse_one_void_ratio(part, &request->void_ratios[n], &request->void_ratio_errors[n]));
    for (size_t i = 0; i < n; i++)
      if (request->void_ratios[i] == request->void_ratios[n])
        TRY_FAIL(STATUS_USAGE, "--void-ratio: %s stands there twice; leave one out", part);
    request->void_ratio_count++;
    at += length + 1;
  }
  if (request->void_ratio_count > 0) {
    request->void_ratio = request->void_ratios[0];
    request->void_ratio_error = request->void_ratio_errors[0];
  }
cleanup:
  return status;
}

static enum status parse_threshold(const struct options *options, struct request *request) {
  const char *text = options_text(options, "threshold");
  if (text == NULL || strcmp(text, "auto") == 0) return STATUS_OK;
  if (strcmp(text, "otsu") == 0) {
    request->rule = THRESHOLD_OTSU;
    return STATUS_OK;
  }
  char *end;
  request->rule = THRESHOLD_VALUE;
  request->threshold = strtod(text, &end);
  if (end == text || *end != '\0' || !isfinite(request->threshold))
    return FAIL(STATUS_USAGE, "--threshold %s: auto, otsu or a grey value is wanted", text);
  return STATUS_OK;
}

static enum status parse_choices(const struct options *options, struct request *request) {
  static const char *const FILTERS[] = {"bicubic", "bicubic-point", "area", "none", NULL};
  static const char *const MIRRORS[] = {"x", "y", "z", "none", NULL};
  static const char *const AXES[] = {"x", "y", "z", NULL};
  static const char *const SIDES[] = {"periodic", "closed", "mirrored", NULL};
  static const char *const GRAINS[] = {"bright", "dark", NULL};
  static const char *const DENOISE[] = {"none", "median", "nlm", NULL};
  static const char *const ISLANDS[] = {"keep", "fill", NULL};
  static const char *const BLUR[] = {"remove", "keep", NULL};
  enum status status = STATUS_OK;
  int filter = FILTER_BICUBIC, mirror = 2, grain = 0, islands = 0, denoise = 0, sides = 0;
  int blur = 0;
  TRY(options_choice(options, "filter", FILTERS, &filter));
  TRY(options_choice(options, "mirror", MIRRORS, &mirror));
  TRY(options_choice(options, "sides", SIDES, &sides));
  request->sides = (enum sides)sides;
  request->sides_stated = request->sides == SIDES_PERIODIC && options_given(options, "sides");
  if (request->sides == SIDES_CLOSED && mirror < 2)
    TRY_FAIL(
        STATUS_USAGE,
        "--sides closed: the sides are x and y, of which --mirror %s makes one periodic; mirror z",
        MIRRORS[mirror]);
  request->flow_axis = 2;
  TRY(options_choice(options, "flow", AXES, &request->flow_axis));
  TRY(options_choice(options, "grain", GRAINS, &grain));
  TRY(options_choice(options, "islands", ISLANDS, &islands));
  TRY(options_choice(options, "denoise", DENOISE, &denoise));
  TRY(options_choice(options, "blur", BLUR, &blur));
  request->keep_blur = blur == 1;
  request->filter = (enum filter)filter;
  request->denoise = (enum denoise)denoise;
  request->mirror = mirror < 3;
  request->mirror_axis = mirror < 3 ? mirror : 2;
  request->dark_grains = grain == 1;
  request->fill_islands = islands == 1;
cleanup:
  return status;
}

static enum status parse_correct(const struct options *options, struct request *request) {
  const char *text = options_text(options, "correct"), *axis = options_text(options, "axis");
  char rest;
  request->axis[0] = request->axis[1] = NAN;
  if (axis != NULL &&
      (sscanf(axis, "%lf,%lf%c", &request->axis[0], &request->axis[1], &rest) != 2 ||
       !isfinite(request->axis[0]) || !isfinite(request->axis[1])))
    return FAIL(STATUS_USAGE, "--axis %s: X,Y is wanted, e.g. 512,498.5", axis);
  if (text == NULL) return STATUS_OK;
  request->correct_beam = strcmp(text, "rings") != 0;
  request->correct_rings = strcmp(text, "beam") != 0;
  if (strcmp(text, "beam") == 0 || strcmp(text, "rings") == 0 || strcmp(text, "beam,rings") == 0 ||
      strcmp(text, "rings,beam") == 0)
    return STATUS_OK;
  return FAIL(STATUS_USAGE, "--correct %s: beam, rings or beam,rings is wanted", text);
}

/* Names the output: of a survey a page, of a sweep a table, of a build a model. */
static enum status name_output(const struct options *options, struct request *request) {
  static const char *const PAGE[] = {".html", ".htm", NULL};
  static const char *const MODEL[] = {".hdf", ".h5", ".hdf5", NULL};
  static const char *const TABLE[] = {".csv", ".txt", ".tsv", ".dat", NULL};
  const bool build = strcmp(options_command(options), "build") == 0, survey = request->survey;
  const char *given = options_text(options, "output");
  if (given == NULL || given[0] == '\0') {
    request->output = given;
    return STATUS_OK;
  }
  request->output = request->named;
  return output_name(given,
                     survey  ? PAGE
                     : build ? MODEL
                             : TABLE,
                     survey  ? "a page is HTML (a browser prints it to PDF)"
                     : build ? "a model is an HDF5 file"
                             : "the curve is a table of text",
                     request->named, sizeof request->named);
}

static enum status parse_micro(const struct options *options, struct request *request) {
  enum status status = STATUS_OK;
  const char *greys = options_text(options, "micro");
  const char *permeability = options_text(options, "micro-permeability");
  static const char *const CLASH[] = {"segmented", "threshold", "roi", "denoise", "correct"};
  if (greys == NULL && permeability == NULL) return STATUS_OK;
  if (greys == NULL || permeability == NULL)
    TRY_FAIL(STATUS_USAGE, "--micro says which greys are soil, --micro-permeability what "
                           "flows through it: both are wanted");
  for (size_t i = 0; i < sizeof CLASH / sizeof *CLASH; i++)
    if (options_given(options, CLASH[i]))
      TRY_FAIL(STATUS_USAGE, "--micro says what each grey is: leave --%s out", CLASH[i]);
  TRY(micro_rules_parse(greys, &request->micro));
  TRY(soil_parse_permeability("micro-permeability", permeability, &request->micro.permeability,
                              &request->micro.grain_size));
cleanup:
  return status;
}

/* A survey has one void ratio, or none yet: then it begins at Otsu's threshold. */
static enum status check_survey(struct request *request) {
  if (request->output == NULL) return FAIL(STATUS_USAGE, "survey: -o page.html is missing");
  if (request->void_ratio_count > 1)
    return FAIL(STATUS_USAGE, "survey: one --void-ratio is possible; sweep takes several");
  if (request->void_ratio_count == 0 && request->rule == THRESHOLD_AUTO)
    request->rule = THRESHOLD_OTSU;
  return STATUS_OK;
}

enum status request_parse(const struct options *options, struct request *request) {
  enum status status = STATUS_OK;
  bool build = strcmp(options_command(options), "build") == 0;
  bool info = strcmp(options_command(options), "info") == 0;
  *request = (struct request){.void_ratio = NAN, .void_ratio_error = NAN, .scale_peak = NAN};
  if (options_given(options, "raw"))
    TRY(raw_layout_parse(options_text(options, "raw"), &request->raw));
  TRY(parse_voxel_size(options, request));
  if (info) goto cleanup;
  const char *crop = options_text(options, "crop");
  request->survey = strcmp(options_command(options), "survey") == 0;
  request->crop_auto = crop != NULL && strcmp(crop, "auto") == 0;
  request->crop_given = crop != NULL && !request->crop_auto;
  request->size_given = options_given(options, "size");
  request->grain_given = options_given(options, "grain");
  TRY(name_output(options, request));
  if (options_given(options, "roi")) TRY(roi_parse(options_text(options, "roi"), &request->roi));
  if (request->crop_given)
    TRY(parse_numbers(options, "crop", ',', 6, "0,0,0,480,480,248", request->crop));
  TRY(parse_numbers(options, "size", 'x', 3, "60x60x31", request->size));
  long long levels = 1;
  if (options_given(options, "levels")) TRY(options_integers(options, "levels", ',', 1, &levels));
  if (levels < 1 || levels > 5)
    TRY_FAIL(STATUS_USAGE, "--levels %s: 1 to 5 models are possible",
             options_text(options, "levels"));
  request->levels = (int)levels;
  TRY(parse_void_ratio(options, request));
  TRY(options_number(options, "scale-peak", &request->scale_peak));
  TRY(parse_threshold(options, request));
  TRY(parse_choices(options, request));
  TRY(parse_correct(options, request));
  if (options_given(options, "scale-peak") && !(request->scale_peak > 0.0))
    TRY_FAIL(STATUS_USAGE, "--scale-peak %s: must be above 0", options_text(options, "scale-peak"));
  if (options_given(options, "segmented"))
    TRY(labels_parse(options_text(options, "segmented"), &request->labels));
  TRY(parse_micro(options, request));
  static const char *const OF_GREYS[] = {"threshold", "grain", "denoise",
                                         "correct",   "roi",   "scale-peak"};
  for (size_t i = 0; request->labels.given && i < sizeof OF_GREYS / sizeof *OF_GREYS; i++)
    if (options_given(options, OF_GREYS[i]))
      TRY_FAIL(STATUS_USAGE,
               "--%s is for greys, and --segmented says that there are none: leave "
               "one of them out",
               OF_GREYS[i]);
  if (build && request->output == NULL) TRY_FAIL(STATUS_USAGE, "build: -o model.hdf is missing");
  if (request->survey) TRY(check_survey(request));
cleanup:
  return status;
}
