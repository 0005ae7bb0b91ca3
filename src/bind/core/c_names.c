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

/* <math.h> of C17 and C23, and <complex.h>: these with suffixes, too */
static const char functions[] =
    " cabs cacos cacosh carg casin casinh catan catanh ccos ccosh cexp cimag clog conj cpow cproj "
    "creal csin csinh csqrt ctan ctanh acos acosh acospi asin asinh asinpi atan atan2 atan2pi "
    "atanh atanpi canonicalize cbrt ceil "
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
    "islessequal islessgreater isnormal issignaling issubnormal isunordered iszero "
    "math_errhandling signbit signgam HUGE_VAL HUGE_VALF HUGE_VALL INFINITY NAN SNAN SNANF SNANL "
    "MAXFLOAT ";
/* these with suffixes, too */
static const char constants[] =
    " M_E M_LOG2E M_LOG10E M_LN2 M_LN10 M_PI M_PI_2 M_PI_4 M_1_PI M_2_PI M_2_SQRTPI M_SQRT2 "
    "M_SQRT1_2 ";
/* C's types, and those of GNU, which C++ takes: _Float32x has f32x */
static const char suffixes[] = " f l f16 f32 f64 f128 f32x f64x ";
/* f32addf64 is a function that rounds once */
static const char rounded[] = " f d f32 f64 f32x f64x ";
static const char operations[] = " add div fma mul sqrt sub ";
static const char of_math[] =
    " FP_ MATH_ HUGE_VAL_F SNANF "; /* the standard keeps these beginnings */

/* which a program is linked with, whatever it includes; compilers know their types */
static const char library[] =
    " abort abs acct aligned_alloc alloca asctime at_quick_exit atexit atof atoi atol atoll bcmp "
    "bcopy bsearch btowc bzero calloc clearerr clock close ctime "
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
/* macros and types of its headers, which a program may include beside the text */
static const char macros[] =
    " and and_eq assert BUFSIZ bitand bitor char16_t char32_t CLOCKS_PER_SEC clock_t CMPLX CMPLXF "
    "CMPLXL cnd_t compl complex DECIMAL_DIG div_t EDOM EILSEQ EOF ERANGE errno EXIT_FAILURE "
    "EXIT_SUCCESS fenv_t fexcept_t FILE FILENAME_MAX FOPEN_MAX fpos_t I imaxdiv_t INT_MAX INT_MIN "
    "int8_t int16_t int32_t int64_t intmax_t intptr_t jmp_buf kill_dependency ldiv_t lldiv_t "
    "L_tmpnam max_align_t MB_CUR_MAX MB_LEN_MAX mbstate_t mtx_t not not_eq noreturn NULL offsetof "
    "once_flag ONCE_FLAG_INIT or or_eq ptrdiff_t RAND_MAX SIGABRT SIGFPE SIGILL SIGINT SIGSEGV "
    "SIGTERM sig_atomic_t SIZE_MAX size_t stderr stdin stdout thrd_start_t thrd_t time_t TMP_MAX "
    "TSS_DTOR_ITERATIONS tss_dtor_t tss_t UINT_MAX uint8_t uint16_t uint32_t uint64_t uintmax_t "
    "uintptr_t va_arg va_copy va_end va_list va_start wchar_t wctrans_t wctype_t WEOF wint_t xor "
    "xor_eq ";
static const char of_macros[] =
    " ATOMIC_ atomic_ CHAR_ DBL_ FE_ FLT_ INT8_ INT16_ INT32_ INT64_ INTMAX_ INTPTR_ INT_FAST "
    "INT_LEAST int_fast int_least LC_ LDBL_ LLONG_ LONG_ memory_order PRId PRIi PRIo PRIu PRIX "
    "PRIx PTRDIFF_ SCHAR_ SCNd SCNi SCNo SCNu SCNx SEEK_ SHRT_ SIG_ TIME_ UCHAR_ UINT8_ UINT16_ "
    "UINT32_ UINT64_ UINTMAX_ UINTPTR_ UINT_FAST UINT_LEAST uint_fast uint_least ULLONG_ ULONG_ "
    "USHRT_ WCHAR_ WINT_ ";
static const char helpers[] = " reciprocal_root reciprocal_root3 ";

/* Do the first `length` letters of name stand in the list? */
static int is_listed(const char *list, const char *name, size_t length) {
    for (const char *at = list + 1; *at; at += strcspn(at, " ") + 1)
        if (strcspn(at, " ") == length && strncmp(at, name, length) == 0) return 1;
    return 0;
}

/* One that ends in _ begins macros, which have no small letters: LC_ALL, but not LC_circuit. */
static int begins_listed(const char *list, const char *name) {
    static const char small[] = "abcdefghijklmnopqrstuvwxyz";
    const int is_small = name[strcspn(name, small)] != 0;
    for (const char *at = list + 1; *at; at += strcspn(at, " ") + 1) {
        const size_t length = strcspn(at, " ");
        const int is_macro = at[length - 1] == '_' && !strchr(small, *at);
        if (strncmp(at, name, length) == 0 && !(is_macro && is_small)) return 1;
    }
    return 0;
}

/* Is the name one of the list, with or without one of the suffixes? */
static int is_with_suffix(const char *list, const char *name) {
    const size_t length = strlen(name);
    if (is_listed(list, name, length)) return 1;
    for (size_t k = 1; k < length; k++)
        if (is_listed(suffixes, name + k, length - k) && is_listed(list, name, k)) return 1;
    return 0;
}

static int is_rounded(const char *name) {
    for (size_t k = 1; k < strlen(name); k++)
        if (is_listed(rounded, name, k) && is_with_suffix(operations, name + k)) return 1;
    return 0;
}

static int is_of_math(const char *name) {
    return is_with_suffix(functions, name) || is_with_suffix(constants, name) || is_rounded(name) ||
           strncmp(name, "lgamma", 6) == 0 || is_listed(in_math, name, strlen(name)) ||
           begins_listed(of_math, name);
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
    if (is_of_math(name)) return "stands in <math.h>, which the text includes, or in <complex.h>";
    if (is_listed(library, name, length)) return "is a function of the C library";
    if (is_listed(macros, name, length) || begins_listed(of_macros, name))
        return "is a macro or a type of the C library";
    if (is_listed(helpers, name, length)) return "is a helper that the text may have";
    return NULL;
}
