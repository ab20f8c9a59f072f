<ColorCorrection id="x">
<SOPNode>
<Description>
in 2019, out of the box
width of the gamut
</Description>
<Slope>2 0.5 1</Slope><Offset>0 0 0.1</Offset><Power>1 1 1</Power>
</SOPNode>
</ColorCorrection>
