/* Units of length as other programs write them in the headers of images. */
#ifndef TOSUI_CT2MODEL_READERS_LENGTH_UNIT_H
#define TOSUI_CT2MODEL_READERS_LENGTH_UNIT_H

/* The unit in metres, as "micron", "um", "&#181;m" or "mm"; NAN if it is none. */
double length_unit(const char *unit);

#endif
