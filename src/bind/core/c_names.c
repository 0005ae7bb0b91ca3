#include "bind/core/c_names.h"

#include <stddef.h>
#include <string.h>

/* Lists of names, each between blanks. */
static const char words[] =
    " auto break case char const continue default do double else enum extern float for goto if "
    "inline int long register restrict return short signed sizeof static struct switch typedef "
    "union unsigned void volatile while main "
    /* since C23, and in the dialect of GNU, which compilers take unless told otherwise */
    "alignas alignof bool constexpr false nullptr static_assert thread_local true typeof "
    "typeof_unqual asm linux unix ";

/* <math.h> of C17 and C23: these with the suffixes f and l, too */
static const char functions[] =
    " acos acosh acospi asin asinh asinpi atan atan2 atan2pi atanh atanpi canonicalize cbrt ceil "
    "compoundn copysign cos cosh cospi drem erf erfc exp exp10 exp10m1 exp2 exp2m1 expm1 fabs fdim "
    "finite floor fma fmax fmaximum fmaximum_mag fmaximum_mag_num fmaximum_num fmaxmag fmin "
    "fminimum fminimum_mag fminimum_mag_num fminimum_num fminmag fmod frexp fromfp fromfpx gamma "
    "getpayload hypot ilogb isinf isnan j0 j1 jn ldexp lgamma llogb llrint llround log log10 "
    "log10p1 log1p log2 log2p1 logb logp1 lrint lround modf nan nearbyint nextafter nextdown "
    "nexttoward nextup pow pown powr remainder remquo rint rootn round roundeven rsqrt scalb "
    "scalbln scalbn setpayload setpayloadsig significand sin sincos sinh sinpi sqrt tan tanh tanpi "
    "tgamma totalorder totalordermag trunc ufromfp ufromfpx y0 y1 yn ";
static const char in_math[] =
    " double_t float_t fpclassify iscanonical iseqsig isfinite isgreater isgreaterequal isless "
    "islessequal islessgreater isnormal issignaling issubnormal isunordered iszero lgamma_r "
    "lgammaf_r lgammal_r math_errhandling signbit signgam ffma fadd fsub fmul fdiv fsqrt HUGE_VAL "
    "HUGE_VALF HUGE_VALL INFINITY NAN SNAN SNANF SNANL M_E M_LOG2E M_LOG10E M_LN2 M_LN10 M_PI "
    "M_PI_2 M_PI_4 M_1_PI M_2_PI M_2_SQRTPI M_SQRT2 M_SQRT1_2 M_El M_LOG2El M_LOG10El M_LN2l "
    "M_LN10l M_PIl M_PI_2l M_PI_4l M_1_PIl M_2_PIl M_2_SQRTPIl M_SQRT2l M_SQRT1_2l ";
static const char of_math[] = " FP_ MATH_ "; /* the standard keeps these beginnings */

/* which a program is linked with, whatever it includes; compilers know their types */
static const char library[] =
    " abort abs acct aligned_alloc alloca asctime at_quick_exit atexit atof atoi atol atoll bcmp "
    "bcopy bsearch btowc bzero cabs calloc cexp clearerr clock close cpow csin csqrt ctime "
    "difftime div execl execv exit fclose feof ferror fflush ffs fgetc fgetpos fgets fopen fork "
    "fprintf fputc fputs fread free freopen fscanf fseek fsetpos ftell fwrite getc getchar "
    "getenv gets gmtime index isalnum isalpha isascii isblank iscntrl isdigit isgraph islower "
    "isprint ispunct isspace isupper isxdigit labs ldiv llabs lldiv localeconv localtime "
    "longjmp malloc mblen mbstowcs mbtowc memchr memcmp memcpy memmove memset mktime open "
    "perror printf putc putchar puts qsort quick_exit raise rand read realloc remove rename "
    "rewind rindex scanf setbuf setjmp setlocale setvbuf signal snprintf sprintf srand sscanf "
    "strcat strchr strcmp strcoll strcpy strcspn strdup strerror strftime strlen strncat "
    "strncmp strncpy strndup strpbrk strrchr strspn strstr strtod strtof strtok strtol strtold "
    "strtoll strtoul strtoull strxfrm system time timespec_get tmpfile tmpnam tolower toupper "
    "towlower towupper ungetc vfprintf vfscanf vprintf vscanf vsnprintf vsprintf vsscanf "
    "wcstombs wctomb write ";
static const char helpers[] = " reciprocal_root reciprocal_root3 ";

/* Do the first `length` letters of name stand in the list? */
static int is_listed(const char *list, const char *name, size_t length) {
    for (const char *at = list + 1; *at; at += strcspn(at, " ") + 1)
        if (strcspn(at, " ") == length && strncmp(at, name, length) == 0) return 1;
    return 0;
}

static int begins_listed(const char *list, const char *name) {
    for (const char *at = list + 1; *at; at += strcspn(at, " ") + 1)
        if (strncmp(at, name, strcspn(at, " ")) == 0) return 1;
    return 0;
}

static int is_of_math(const char *name) {
    const size_t length = strlen(name);
    const char last = name[length - 1];
    return is_listed(functions, name, length) ||
           ((last == 'f' || last == 'l') && is_listed(functions, name, length - 1)) ||
           is_listed(in_math, name, length) || begins_listed(of_math, name);
}

const char *dml_c_taken(const char *name) {
    static const char capitals[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZ_";
    static const char letters[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_0123456789";
    const size_t length = strlen(name);
    if (!length || strchr("0123456789", *name) || name[strspn(name, letters)])
        return "is none: it must be letters, digits and _, no digit first";
    if (is_listed(words, name, length)) return "is a word of C";
    if (*name == '_' && length > 1 && strchr(capitals, name[1]))
        return "is reserved for compilers, as all that begin with __ or _ and a capital";
    if (is_of_math(name)) return "stands in <math.h>, which the text includes";
    if (is_listed(library, name, length)) return "is a function of the C library";
    if (is_listed(helpers, name, length)) return "is a helper that the text may have";
    return NULL;
}
