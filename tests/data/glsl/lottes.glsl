// T. Lottes, Advanced Techniques and Optimization of HDR Color Pipelines, 2016.
uniform float contrast = 1.6;
uniform float shoulder = 0.977;
uniform float hdrMax;
uniform float midIn;
uniform float midOut;

float lottes(float x)
{
    float ad = contrast*shoulder;
    float b = (pow(hdrMax, contrast)*midOut - pow(midIn, contrast))
            / ((pow(hdrMax, ad) - pow(midIn, ad))*midOut);
    float c = (pow(hdrMax, ad)*pow(midIn, contrast) - pow(hdrMax, contrast)*pow(midIn, ad)*midOut)
            / ((pow(hdrMax, ad) - pow(midIn, ad))*midOut);
    return pow(x, contrast)/(pow(x, ad)*b + c);
}
